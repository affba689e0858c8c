#pragma once

#include "logs/figures/figures.h"

namespace roundabout::logs {

inline constexpr plot::CanvasSize kTimeFigureSize{1000, 330};

/// Starts a picture over data time since the first frame, with the ways to formations shaded.
void beginTimeFigure(plot::GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                     const Figure& figure);

}  // namespace roundabout::logs
