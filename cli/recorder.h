#pragma once

#include <filesystem>
#include <string>

#include "cli/process.h"
#include "common/bus/bus.h"

namespace roundabout::cli {

/// The stock lcm-logger, known to record: the first message of a flight is in its file, and so is
/// the last.
class Recorder {
 public:
  /// Starts lcm-logger and returns once a marker has reached the file. The bus is on the same URL.
  /// Throws core::StartupError if the logger cannot be started, ends, or records nothing for 5 s.
  Recorder(bus::Bus& bus, const std::string& lcm_url, std::filesystem::path file,
           const std::filesystem::path& output_file);

  ChildProcess& process() { return process_; }
  /// Waits until everything that was published before has been written, then ends the logger.
  /// Returns why the log may lack its end; empty if it is complete.
  std::string close();

 private:
  bool waitUntilRecorded(const std::string& marker, double limit_s);

  bus::Bus& bus_;
  std::filesystem::path file_;
  ChildProcess process_;
};

}  // namespace roundabout::cli
