#pragma once

#include <memory>

#include "planner/policies/table.h"

namespace roundabout::planner {

/// Optimal reciprocal collision avoidance (van den Berg, Guy, Lin, Manocha 2011); see
/// docs/policies.md. Uses options.orca, whose times and radius factor are positive.
std::unique_ptr<Policy> makeOrca(const PolicyOptions& options);

}  // namespace roundabout::planner
