#include "logs/reading/event_log.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::logs {

namespace {

constexpr const char* kExpected = "an LCM event log (sync word 0xEDA1DA01)";

}  // namespace

class EventLog::MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
      throw core::StartupError(path, "log", kExpected, std::strerror(errno));
    }
    struct stat status {};
    std::string problem;
    if (fstat(descriptor, &status) != 0) {
      problem = std::strerror(errno);
    } else if (!S_ISREG(status.st_mode)) {
      problem = "something that is not a file";
    } else if (status.st_size == 0) {
      problem = "an empty file";
    } else {
      size_ = static_cast<std::size_t>(status.st_size);
      memory_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
      problem = memory_ == MAP_FAILED ? std::strerror(errno) : "";
    }
    close(descriptor);
    if (!problem.empty()) {
      throw core::StartupError(path, "log", kExpected, problem);
    }
  }
  ~MappedFile() { munmap(memory_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const {
    return {static_cast<const std::byte*>(memory_), size_};
  }

 private:
  void* memory_ = nullptr;
  std::size_t size_ = 0;
};

EventLog::EventLog(const std::string& path)
    : path_(path), file_(std::make_unique<MappedFile>(path)), scan_(scanEvents(file_->bytes())) {
  if (scan_.offsets.empty()) {
    throw core::StartupError(path, "log", kExpected,
                             fmt::format("{} bytes without one event", fileBytes()));
  }
}

EventLog::~EventLog() = default;
EventLog::EventLog(EventLog&&) noexcept = default;
EventLog& EventLog::operator=(EventLog&&) noexcept = default;

Event EventLog::operator[](std::size_t index) const {
  return eventAt(file_->bytes(), scan_.offsets[index]);
}

std::size_t EventLog::fileBytes() const { return file_->bytes().size(); }

}  // namespace roundabout::logs
