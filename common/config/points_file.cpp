#include "common/config/points_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::config {

std::vector<Eigen::Vector3d> readPointsFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    throw core::StartupError(path, "points_file", "a file that can be read", std::strerror(errno));
  }
  std::vector<Eigen::Vector3d> points_m;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::string text = line.substr(0, line.find('#'));
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream words(text);
    std::vector<double> values;
    std::string word;
    bool readable = true;
    while (words >> word) {
      char* end = nullptr;
      values.push_back(std::strtod(word.c_str(), &end));
      readable = readable && *end == '\0' && std::isfinite(values.back());
    }
    if (values.empty()) {
      continue;
    }
    if (!readable || values.size() < 2 || values.size() > 3) {
      throw core::StartupError(fmt::format("{}:{}", path, number), "point", "x, y or x, y, z",
                               fmt::format("\"{}\"", line));
    }
    values.resize(3, std::numeric_limits<double>::quiet_NaN());
    points_m.emplace_back(values[0], values[1], values[2]);
  }
  if (points_m.empty()) {
    throw core::StartupError(path, "points_file", "at least one point", "none");
  }
  return points_m;
}

}  // namespace roundabout::config
