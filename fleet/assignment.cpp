#include "fleet/assignment.h"

#include <numeric>

#include "common/core/random.h"

namespace roundabout::fleet {

Assignment assignInOrder(std::size_t vehicles, std::size_t points) {
  Assignment assignment(vehicles, kUnassigned);
  std::iota(assignment.begin(), assignment.begin() + static_cast<std::ptrdiff_t>(points), 0u);
  return assignment;
}

Assignment assignAtRandom(std::size_t vehicles, std::size_t points, std::uint64_t seed,
                          const std::string& stream) {
  Assignment assignment = assignInOrder(vehicles, points);
  core::RandomStream random(seed, stream);
  random.shuffle(assignment);
  return assignment;
}

Assignment assignOptimally(const std::vector<Eigen::Vector3d>& vehicles_m,
                           const std::vector<Eigen::Vector3d>& points_m) {
  Eigen::MatrixXd cost(points_m.size(), vehicles_m.size());
  for (std::size_t j = 0; j < points_m.size(); ++j) {
    for (std::size_t i = 0; i < vehicles_m.size(); ++i) {
      cost(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) =
          (vehicles_m[i] - points_m[j]).squaredNorm();
    }
  }
  return core::assignAtLeastCost(cost);
}

}  // namespace roundabout::fleet
