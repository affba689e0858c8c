#pragma once

#include <array>
#include <numbers>

#include "planner/policy.h"

namespace roundabout::planner {

inline constexpr double kTwelfthTurn_rad = std::numbers::pi / 6.0;

/// In the order of the published networks' outputs (gym-collision-avoidance; the paper's text and
/// its code differ in how many there are, and the networks have the code's 11).
inline constexpr std::array<DiscreteAction, 11> kActions = {{{1.0, -kTwelfthTurn_rad},
                                                             {1.0, -kTwelfthTurn_rad / 2.0},
                                                             {1.0, 0.0},
                                                             {1.0, kTwelfthTurn_rad / 2.0},
                                                             {1.0, kTwelfthTurn_rad},
                                                             {0.5, -kTwelfthTurn_rad},
                                                             {0.5, 0.0},
                                                             {0.5, kTwelfthTurn_rad},
                                                             {0.0, -kTwelfthTurn_rad},
                                                             {0.0, 0.0},
                                                             {0.0, kTwelfthTurn_rad}}};

}  // namespace roundabout::planner
