#include "logs/files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/core/error.h"

namespace roundabout::logs {

void writeFile(const std::string& file, std::string_view content) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) {
    throw core::StartupError(file, "output", "a file that can be written", std::strerror(errno));
  }
}

std::string readFile(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw core::StartupError(file, "input", "a file that can be read", std::strerror(errno));
  }
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

void makeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw core::StartupError(folder, "output", "a folder that can be made", error.message());
  }
}

}  // namespace roundabout::logs
