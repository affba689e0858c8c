#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace roundabout::fleet {

/// For each vehicle the index of its point, or kUnassigned: there may be fewer points than
/// vehicles.
using Assignment = std::vector<std::size_t>;
inline constexpr std::size_t kUnassigned = static_cast<std::size_t>(-1);

/// Point i to vehicle i.
Assignment assignInOrder(std::size_t vehicles, std::size_t points);

/// A random one, the same for the same seed and stream name. Precondition: points <= vehicles.
Assignment assignAtRandom(std::size_t vehicles, std::size_t points, std::uint64_t seed,
                          const std::string& stream);

/// Least total cost, exact (Hungarian method with potentials, O(points^2 vehicles)). A row a point,
/// a column a vehicle. Precondition: all finite, rows <= columns.
Assignment assignAtLeastCost(const Eigen::MatrixXd& cost);

/// Least total squared distance. Precondition: points <= vehicles.
Assignment assignOptimally(const std::vector<Eigen::Vector3d>& vehicles_m,
                           const std::vector<Eigen::Vector3d>& points_m);

}  // namespace roundabout::fleet
