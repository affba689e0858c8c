#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace roundabout::logs {

/// A file's bytes, mapped into memory for reading.
class MappedFile {
 public:
  /// Throws core::StartupError, as a log that cannot be read, if it is missing or no file. An empty
  /// file has no bytes.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const {
    return {static_cast<const std::byte*>(memory_), size_};
  }
  /// When it was last written to.
  std::int64_t modifiedNs() const { return modified_ns_; }

 private:
  void* memory_ = nullptr;
  std::size_t size_ = 0;
  std::int64_t modified_ns_ = 0;
};

/// What a log that cannot be read was expected to be.
inline constexpr const char* kExpectedLog = "an LCM event log (sync word 0xEDA1DA01)";

}  // namespace roundabout::logs
