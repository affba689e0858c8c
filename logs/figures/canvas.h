#pragma once

#include <string>

#include "common/plot/gnuplot_script.h"
#include "logs/figures/figures.h"

namespace roundabout::logs {

using plot::GnuplotScript;
using plot::gnuplotString;

/// Pixels of the page; bitmaps have twice as many each way.
struct CanvasSize {
  int width = 1000;
  int height = 400;
};

/// Starts a picture: forgets what the picture before set and gives the house's look.
void beginFigure(GnuplotScript& script, const CanvasSize& size, const std::string& title);

/// Writes what `plot` (a whole plot command) draws to both files of the figure.
void endFigure(GnuplotScript& script, const CanvasSize& size, const Figure& figure,
               const std::string& plot);

}  // namespace roundabout::logs
