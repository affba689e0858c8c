#pragma once

#include <cstddef>
#include <filesystem>
#include <ios>
#include <string>
#include <utility>
#include <vector>

namespace roundabout::cli {

/// The last bytes of a file, all of it if it is smaller; empty if it cannot be read.
std::string fileTail(const std::filesystem::path& file, std::size_t bytes);

/// Reads on in a file that another process writes.
class FileFollower {
 public:
  explicit FileFollower(std::filesystem::path file) : file_(std::move(file)) {}
  /// Whole lines that were not given before; none if the file cannot be read.
  std::vector<std::string> newLines();

 private:
  std::filesystem::path file_;
  std::streamoff read_ = 0;
};

}  // namespace roundabout::cli
