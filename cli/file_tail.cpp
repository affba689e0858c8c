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

}  // namespace roundabout::cli
