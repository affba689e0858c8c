#include "logs/figures/time_axis.h"

#include <algorithm>
#include <cmath>

namespace roundabout::logs {

using namespace plot;  // NOLINT(google-build-using-namespace): the drawing of this file

void beginTimeFigure(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                     const Figure& figure) {
  beginFigure(script, kTimeFigureSize, figure.title);
  script.line("set title offset 0,0.6");
  script.line("set rmargin 18");
  script.line("set xlabel \"time (s)\"");
  script.line("set xrange [0:{:.3f}]",
              std::max(flight.secondsAt(flight.frames.back().utime), 1e-3));
  script.line("set key at graph 1.02, 1 left top Left reverse samplen 1.5 spacing 1.2");
  int object = 1;
  for (const FormationMetrics& formation : metrics.formations) {
    const double begin_s = formation.begin_at_s;
    const double end_s = formation.formed && std::isfinite(formation.time_to_form_s)
                             ? begin_s + formation.time_to_form_s
                             : formation.end_at_s;
    script.line(
        "set object {} rectangle from first {:.3f}, graph 0 to first {:.3f}, graph 1 behind "
        "fc rgb \"#f1f3f6\" fs solid noborder",
        object, begin_s, end_s);
    script.line(
        "set label {} {} at first {:.3f}, graph 1.05 center noenhanced tc rgb \"#777777\" "
        "font \",12\"",
        object++, gnuplotString(formation.name), (begin_s + end_s) / 2.0);
  }
}

}  // namespace roundabout::logs
