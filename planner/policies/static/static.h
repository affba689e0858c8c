#pragma once

#include <memory>

#include "planner/policies/table.h"

namespace roundabout::planner {

/// Stands still (paper: "Zero Velocity").
std::unique_ptr<Policy> makeStatic(const PolicyOptions& options);

}  // namespace roundabout::planner
