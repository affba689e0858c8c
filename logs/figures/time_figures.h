#pragma once

#include "logs/figures/figures.h"

namespace roundabout::logs {

using plot::GnuplotScript;

/// Each fills in the figure's title and caption. Time is data time since the first frame;
/// formations are shaded.

/// The closest gap between bodies, with where bodies touch and where assumed radii do.
void drawSeparation(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                    Figure& figure);

/// Every vehicle's speed.
void drawSpeed(GnuplotScript& script, const Flight& flight, const Metrics& metrics, Figure& figure);

/// Every planner's mode: a bar each.
void drawModes(GnuplotScript& script, const Flight& flight, const Metrics& metrics, Figure& figure);

/// Frames, and every planner's commands, a second of data time: what is missing shows.
void drawRates(GnuplotScript& script, const Flight& flight, const Metrics& metrics, Figure& figure);

/// From a frame to the command that answers it, by the logger's clock.
void drawLatency(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                 Figure& figure);

/// The shortest and the longest interval between frames, by log time.
void drawFrameIntervals(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                        Figure& figure);

}  // namespace roundabout::logs
