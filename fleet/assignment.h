#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/core/assignment.h"

namespace roundabout::fleet {

/// For each vehicle the index of its point, or kUnassigned: there may be fewer points than
/// vehicles.
using core::Assignment;
using core::kUnassigned;

/// Point i to vehicle i.
Assignment assignInOrder(std::size_t vehicles, std::size_t points);

/// A random one, the same for the same seed and stream name. Precondition: points <= vehicles.
Assignment assignAtRandom(std::size_t vehicles, std::size_t points, std::uint64_t seed,
                          const std::string& stream);

/// Least total squared distance. Precondition: points <= vehicles.
Assignment assignOptimally(const std::vector<Eigen::Vector3d>& vehicles_m,
                           const std::vector<Eigen::Vector3d>& points_m);

}  // namespace roundabout::fleet
