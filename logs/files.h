#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace roundabout::logs {

/// Replaces the file. Throws core::StartupError if it cannot be written.
void writeFile(const std::string& file, std::string_view content);

/// A large file, whole or not at all: it appears under its name when it is finished.
class FileWriter {
 public:
  /// Throws core::StartupError if it cannot be made.
  explicit FileWriter(const std::string& file);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(std::string_view bytes);
  std::uint64_t written() const { return written_; }
  /// Throws core::StartupError if not all could be written.
  void finish();

 private:
  std::string file_;
  std::string draft_;
  std::FILE* stream_;
  std::uint64_t written_ = 0;
};

/// The file's bytes. Throws core::StartupError if it cannot be read.
std::string readFile(const std::string& file);

/// Makes the folder and its parents. Throws core::StartupError if that fails.
void makeFolder(const std::string& folder);

}  // namespace roundabout::logs
