#pragma once

#include <span>

#include "common/core/agent.h"
#include "planner/policies/cadrl/network.h"

namespace roundabout::planner {

/// What the value network sees of the ego and of one to three others, in the order given.
JointState jointState(const core::EgoAgent& ego, std::span<const core::OtherAgent> others);

}  // namespace roundabout::planner
