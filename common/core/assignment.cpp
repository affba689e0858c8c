#include "common/core/assignment.h"

#include <limits>

namespace roundabout::core {

Assignment assignAtLeastCost(const Eigen::MatrixXd& cost) {
  // Points are added one at a time, each along the cheapest alternating path. Column 0 is a helper.
  const auto points = static_cast<std::size_t>(cost.rows());
  const auto columns = static_cast<std::size_t>(cost.cols()) + 1;
  constexpr std::size_t kHelper = 0;
  std::vector<double> point_potential(points + 1, 0.0);
  std::vector<double> vehicle_potential(columns, 0.0);
  std::vector<std::size_t> point_of(columns, 0);  // one-based; 0: free
  std::vector<std::size_t> previous(columns, 0);

  for (std::size_t point = 1; point <= points; ++point) {
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
        const double reduced =
            cost(static_cast<Eigen::Index>(from) - 1, static_cast<Eigen::Index>(j) - 1) -
            point_potential[from] - vehicle_potential[j];
        if (reduced < cheapest[j]) {
          cheapest[j] = reduced;
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

  Assignment assignment(columns - 1, kUnassigned);
  for (std::size_t j = 1; j < columns; ++j) {
    if (point_of[j] != 0) {
      assignment[j - 1] = point_of[j] - 1;
    }
  }
  return assignment;
}

}  // namespace roundabout::core
