#pragma once

#include "logs/figures/figures.h"
#include "logs/replay/command_check.h"

namespace roundabout::logs {

/// One vehicle's path from above with, every half second, the velocity that was commanded and the
/// one that another policy would have commanded there. Fills in the figure's title and caption.
void drawWhatIf(plot::GnuplotScript& script, const Flight& flight, const FlightVehicle& vehicle,
                const CommandCheck& check, const std::string& policy, Figure& figure);

}  // namespace roundabout::logs
