#include "logs/files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

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

FileWriter::FileWriter(const std::string& file)
    : file_(file),
      draft_(file + ".part" + std::to_string(getpid())),
      stream_(std::fopen(draft_.c_str(), "wb")) {
  if (stream_ == nullptr) {
    throw core::StartupError(file, "output", "a file that can be written", std::strerror(errno));
  }
}

FileWriter::~FileWriter() {
  if (stream_ != nullptr) {
    std::fclose(stream_);
    std::remove(draft_.c_str());
  }
}

void FileWriter::write(std::string_view bytes) {
  std::fwrite(bytes.data(), 1, bytes.size(), stream_);
  written_ += bytes.size();
}

void FileWriter::finish() {
  const bool failed = std::ferror(stream_) != 0;
  const bool closed = std::fclose(stream_) == 0;
  stream_ = nullptr;
  if (failed || !closed || std::rename(draft_.c_str(), file_.c_str()) != 0) {
    const std::string found = errno == 0 ? "a full disk" : std::strerror(errno);
    std::remove(draft_.c_str());
    throw core::StartupError(file_, "output", "a file that can be written", found);
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
