#pragma once

#include "logs/figures/figures.h"

namespace roundabout::logs {

using plot::GnuplotScript;

/// The way into one formation, seen from above, in the paper's style: every vehicle as a circle of
/// its body radius at regular intervals of data time, darker with time; stars are goals, diamonds
/// starts. Fills in the figure's title and caption.
void drawFormation(GnuplotScript& script, const Flight& flight, const FormationMetrics& formation,
                   Figure& figure);

/// All vehicles' paths over the whole flight, seen from above. Fills in title and caption.
void drawOverview(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                  Figure& figure);

}  // namespace roundabout::logs
