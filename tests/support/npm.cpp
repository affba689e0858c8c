#include "tests/support/npm.h"

#include <chrono>
#include <cstdlib>
#include <fstream>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace roundabout::test {
namespace {

namespace fs = std::filesystem;

/// Tests run side by side, in processes of their own: one installs, the others wait.
class FileLock {
 public:
  explicit FileLock(const fs::path& file)
      : descriptor_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    ::flock(descriptor_, LOCK_EX);
  }
  ~FileLock() { ::close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

bool writtenLately(const fs::path& file) {
  std::error_code absent;
  const auto written = fs::last_write_time(file, absent);
  return !absent && fs::file_time_type::clock::now() - written < std::chrono::minutes(10);
}

}  // namespace

NpmPackage npmPackage(const std::string& name, const std::string& version) {
  if (std::system("command -v npm node >/dev/null 2>&1") != 0) {
    return {{}, "npm is missing: apt-get install npm"};
  }
  const fs::path folder = fs::path(ROUNDABOUT_NPM_DIR) / fs::path(name).filename();
  fs::create_directories(folder);
  const FileLock lock(folder / "lock");
  const fs::path installed = folder / "installed";
  const fs::path refused = folder / "refused";
  const NpmPackage unreachable{{}, "npm cannot fetch " + name + ": its registry does not answer"};
  if (fs::exists(installed)) {
    return {folder / "node_modules", ""};
  }
  if (writtenLately(refused)) {
    return unreachable;
  }
  const std::string install =
      "timeout -k 1 20 npm install --prefix '" + folder.string() +
      "' --ignore-scripts --no-audit --no-fund --no-update-notifier --prefer-offline "
      "--fetch-retries=0 '" +
      name + "@" + version + "' </dev/null >'" + (folder / "npm.log").string() + "' 2>&1";
  const bool done = std::system(install.c_str()) == 0;
  std::ofstream{done ? installed : refused};
  return done ? NpmPackage{folder / "node_modules", ""} : unreachable;
}

}  // namespace roundabout::test
