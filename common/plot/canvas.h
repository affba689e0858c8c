#pragma once

#include <filesystem>
#include <string>

#include "common/plot/gnuplot_script.h"

namespace roundabout::plot {

/// Pixels of the page; bitmaps have twice as many each way.
struct CanvasSize {
  int width = 1000;
  int height = 400;
};

/// Where a picture goes, as a bitmap and as vectors.
struct PictureFiles {
  std::string png;
  std::string svg;
};

/// Starts one page of a picture that plots more than once: `file` gets the ending of its kind.
void beginPage(GnuplotScript& script, const CanvasSize& size, bool bitmap,
               const std::filesystem::path& file);

/// Starts an animation (GIF): every plot command is a frame.
void beginAnimation(GnuplotScript& script, const CanvasSize& size, int frames_per_second,
                    const std::filesystem::path& file, const std::string& title);

/// Starts a picture: forgets what the picture before set and gives the house's look.
void beginFigure(GnuplotScript& script, const CanvasSize& size, const std::string& title);

/// Writes what `plot` (a whole plot command) draws to both files.
void endFigure(GnuplotScript& script, const CanvasSize& size, const PictureFiles& files,
               const std::string& plot);

}  // namespace roundabout::plot
