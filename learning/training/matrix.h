#pragma once

#include <Eigen/Core>

namespace roundabout::learning {

/// Row-major, as weight files are: a row is a sample, or an input of a layer.
using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace roundabout::learning
