#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace roundabout::core {

/// For each column of a cost matrix the index of its row, or kUnassigned.
using Assignment = std::vector<std::size_t>;
inline constexpr std::size_t kUnassigned = static_cast<std::size_t>(-1);

/// Least total cost, exact: every row gets a column of its own (Hungarian method with potentials,
/// O(rows^2 columns)). Precondition: all finite, rows <= columns.
Assignment assignAtLeastCost(const Eigen::MatrixXd& cost);

}  // namespace roundabout::core
