#include "logs/reading/mapped_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::logs {

MappedFile::MappedFile(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    throw core::StartupError(path, "log", kExpectedLog, std::strerror(errno));
  }
  struct stat status {};
  std::string problem;
  if (fstat(descriptor, &status) != 0) {
    problem = std::strerror(errno);
  } else if (!S_ISREG(status.st_mode)) {
    problem = "something that is not a file";
  } else if (status.st_size > 0) {
    size_ = static_cast<std::size_t>(status.st_size);
    modified_ns_ = status.st_mtim.tv_sec * 1'000'000'000L + status.st_mtim.tv_nsec;
    memory_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    problem = memory_ == MAP_FAILED ? std::strerror(errno) : "";
  }
  close(descriptor);
  if (!problem.empty()) {
    throw core::StartupError(path, "log", kExpectedLog, problem);
  }
}

MappedFile::~MappedFile() {
  if (size_ > 0) {
    munmap(memory_, size_);
  }
}

}  // namespace roundabout::logs
