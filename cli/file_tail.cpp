#include "cli/file_tail.h"

#include <algorithm>
#include <fstream>

namespace roundabout::cli {

std::string fileTail(const std::filesystem::path& file, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) {
    return "";
  }
  const auto size = static_cast<std::size_t>(stream.tellg());
  std::string tail(std::min(size, bytes), '\0');
  stream.seekg(-static_cast<std::streamoff>(tail.size()), std::ios::end);
  stream.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return tail;
}

std::vector<std::string> FileFollower::newLines() {
  std::vector<std::string> lines;
  std::ifstream stream(file_, std::ios::binary);
  stream.seekg(read_);
  for (std::string line; std::getline(stream, line) && !stream.eof();) {
    read_ = stream.tellg();
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace roundabout::cli
