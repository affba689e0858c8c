#pragma once

#include "common/core/agent.h"
#include "planner/policies/cadrl/candidates.h"

namespace roundabout::planner {

/// How near two agents come to each other.
struct Encounter {
  double closest_gap_m = 0.0;  ///< at the end or, if they approach first, on the way
  bool collides = false;
};

/// If the ego takes the candidate and the other one goes on for duration_s, of which the first
/// second counts. One that the ego follows is taken for slower than it is, one out of reach for
/// just not close.
Encounter encounterWith(const core::OtherAgent& other, const core::EgoAgent& ego,
                        const Candidate& candidate, double duration_s);

/// Nearer than this is too close. m.
inline constexpr double kCadrlCloseM = 0.2;

}  // namespace roundabout::planner
