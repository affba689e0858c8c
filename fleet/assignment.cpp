#include "fleet/assignment.h"

#include <limits>
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
  // Points are added one at a time, each along the cheapest alternating path. Column 0 is a helper.
  const std::size_t columns = vehicles_m.size() + 1;
  constexpr std::size_t kHelper = 0;
  std::vector<double> point_potential(points_m.size() + 1, 0.0);
  std::vector<double> vehicle_potential(columns, 0.0);
  std::vector<std::size_t> point_of(columns, 0);  // one-based; 0: free
  std::vector<std::size_t> previous(columns, 0);

  for (std::size_t point = 1; point <= points_m.size(); ++point) {
    std::vector<double> cheapest(columns, std::numeric_limits<double>::infinity());
    std::vector<bool> reached(columns, false);
    std::size_t column = kHelper;
    point_of[kHelper] = point;
    do {
      reached[column] = true;
      const std::size_t from = point_of[column];
      double step = std::numeric_limits<double>::infinity();
      std::size_t next = kHelper;
      for (std::size_t j = 1; j < columns; ++j) {
        if (reached[j]) {
          continue;
        }
        const double cost = (vehicles_m[j - 1] - points_m[from - 1]).squaredNorm() -
                            point_potential[from] - vehicle_potential[j];
        if (cost < cheapest[j]) {
          cheapest[j] = cost;
          previous[j] = column;
        }
        if (cheapest[j] < step) {
          step = cheapest[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j < columns; ++j) {
        if (reached[j]) {
          point_potential[point_of[j]] += step;
          vehicle_potential[j] -= step;
        } else {
          cheapest[j] -= step;
        }
      }
      column = next;
    } while (point_of[column] != 0);
    for (; column != kHelper; column = previous[column]) {
      point_of[column] = point_of[previous[column]];
    }
  }

  Assignment assignment(vehicles_m.size(), kUnassigned);
  for (std::size_t j = 1; j < columns; ++j) {
    if (point_of[j] != 0) {
      assignment[j - 1] = point_of[j] - 1;
    }
  }
  return assignment;
}

}  // namespace roundabout::fleet
