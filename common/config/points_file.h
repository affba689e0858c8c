#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace roundabout::config {

/// Reads points, one a line: "x, y" or "x, y, z" in metres, separated by commas or blanks; z is NaN
/// where it is left out. Blank lines and what follows a # are skipped. Throws core::StartupError
/// with FILE:LINE.
std::vector<Eigen::Vector3d> readPointsFile(const std::string& path);

}  // namespace roundabout::config
