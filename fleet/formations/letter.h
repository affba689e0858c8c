#pragma once

#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "common/config/experiment.h"
#include "fleet/formations/stroke_font.h"

namespace roundabout::fleet {

/// Points (m, world) or the reason why there are none.
using PointsOrRefusal = std::variant<std::vector<Eigen::Vector3d>, std::string>;

/// The experiment's own points for a character, if there is one for each vehicle; else nullptr.
const std::vector<Eigen::Vector3d>* ownGlyph(const config::Experiment& experiment, char character);

/// One goal a vehicle on the strokes of a character: its height fleet.letter_height_m, centred on
/// fleet.letter_centre_m, larger where vehicles need more room, refused where that leaves the room.
/// The experiment's own points are used as they are.
PointsOrRefusal letterPoints(const config::Experiment& experiment, const StrokeFont& font,
                             char character);

}  // namespace roundabout::fleet
