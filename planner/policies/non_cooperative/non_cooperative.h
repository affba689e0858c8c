#pragma once

#include <memory>

#include "planner/policies/table.h"

namespace roundabout::planner {

/// Straight to the goal at preferred speed, whoever is in the way (paper: "Non-Cooperative").
std::unique_ptr<Policy> makeNonCooperative(const PolicyOptions& options);

}  // namespace roundabout::planner
