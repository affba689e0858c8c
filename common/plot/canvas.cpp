#include "common/plot/canvas.h"

namespace roundabout::plot {

namespace {

// Bitmaps stay sharp on paper and on dense screens.
constexpr int kPixelScale = 2;

}  // namespace

void beginFigure(GnuplotScript& script, const CanvasSize& size, const std::string& title) {
  script.line("reset");
  script.line("set encoding utf8");
  script.line(
      "set terminal pngcairo noenhanced size {},{} font \"DejaVu Sans,11\" fontscale {} linewidth "
      "{} "
      "pointscale {}",
      kPixelScale * size.width, kPixelScale * size.height, kPixelScale, kPixelScale, kPixelScale);
  script.line("set title {} font \"DejaVu Sans,14\"", gnuplotString(title));
  script.line("set border 3 lc rgb \"#555555\"");
  script.line("set tics nomirror out scale 0.6 tc rgb \"#333333\"");
  script.line("set grid lc rgb \"#e4e4e4\" lw 1 lt 1");
  script.line("set key noautotitle noenhanced");
}

void endFigure(GnuplotScript& script, const CanvasSize& size, const PictureFiles& files,
               const std::string& plot) {
  script.line("set output {}", gnuplotString(files.png));
  script.line("{}", plot);
  script.line("set terminal svg noenhanced size {},{} font \"DejaVu Sans,Helvetica,14\"",
              size.width, size.height);
  script.line("set output {}", gnuplotString(files.svg));
  script.line("replot");
  script.line("set output");
}

}  // namespace roundabout::plot
