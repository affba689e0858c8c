#include "common/plot/canvas.h"

#include <algorithm>

namespace roundabout::plot {

namespace {

// Bitmaps stay sharp on paper and on dense screens.
constexpr int kPixelScale = 2;

constexpr double kTitleSize = 14.0;
// Wide is a letter of a title of that size, on average.
constexpr double kTitleLetter = 9.0;
// Of the width of a picture. A title is in the middle of the axes, not of the picture.
constexpr double kTitleShare = 0.85;

void setBitmap(GnuplotScript& script, const CanvasSize& size) {
  script.line(
      "set terminal pngcairo noenhanced size {},{} font \"DejaVu Sans,11\" fontscale {} linewidth "
      "{} pointscale {}",
      kPixelScale * size.width, kPixelScale * size.height, kPixelScale, kPixelScale, kPixelScale);
}

void setVectors(GnuplotScript& script, const CanvasSize& size) {
  script.line("set terminal svg noenhanced size {},{} font \"DejaVu Sans,Helvetica,14\"",
              size.width, size.height);
}

void setLook(GnuplotScript& script, const CanvasSize& size, const std::string& title) {
  if (!title.empty()) {
    // Smaller if that is what it takes to stay in the picture.
    const double fits =
        kTitleShare * size.width / (kTitleLetter * static_cast<double>(title.size()));
    script.line("set title {} font \"DejaVu Sans,{:.1f}\"", gnuplotString(title),
                kTitleSize * std::min(1.0, fits));
  }
  script.line("set border 3 lc rgb \"#555555\"");
  script.line("set tics nomirror out scale 0.6 tc rgb \"#333333\"");
  script.line("set grid lc rgb \"#e4e4e4\" lw 1 lt 1");
  script.line("set key noautotitle noenhanced");
}

void reset(GnuplotScript& script) {
  script.line("reset");
  script.line("set encoding utf8");
}

}  // namespace

void beginPage(GnuplotScript& script, const CanvasSize& size, bool bitmap,
               const std::filesystem::path& file) {
  reset(script);
  bitmap ? setBitmap(script, size) : setVectors(script, size);
  script.line("set output {}", gnuplotString(file.string() + (bitmap ? ".png" : ".svg")));
  setLook(script, size, "");
}

void beginAnimation(GnuplotScript& script, const CanvasSize& size, int frames_per_second,
                    const std::filesystem::path& file, const std::string& title) {
  reset(script);
  // Not optimized: that leaves every frame the colours of the first one.
  script.line(
      "set terminal gif animate delay {} loop 0 nooptimize noenhanced size {},{} font \",10\"",
      100 / frames_per_second, size.width, size.height);
  script.line("set output {}", gnuplotString(file.string()));
  setLook(script, size, title);
}

void beginFigure(GnuplotScript& script, const CanvasSize& size, const std::string& title) {
  reset(script);
  setBitmap(script, size);
  setLook(script, size, title);
}

void endFigure(GnuplotScript& script, const CanvasSize& size, const PictureFiles& files,
               const std::string& plot) {
  script.line("set output {}", gnuplotString(files.png));
  script.line("{}", plot);
  setVectors(script, size);
  script.line("set output {}", gnuplotString(files.svg));
  script.line("replot");
  script.line("set output");
}

}  // namespace roundabout::plot
