#include "cli/recorder.h"

#include <chrono>
#include <csignal>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "cli/file_tail.h"
#include "cli/wall_clock.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/typed.h"
#include "common/core/error.h"
#include "roundabout_msgs/log_marker_t.hpp"

namespace roundabout::cli {

namespace {

using std::chrono::milliseconds;

constexpr const char* kMarkerChannel = "LOG_MARKER";
constexpr double kStartLimit_s = 5.0;
constexpr double kCloseLimit_s = 20.0;  // of a logger that has fallen behind on a busy machine
constexpr milliseconds kRepeat(20);
constexpr milliseconds kLoggerExitLimit(5000);
constexpr std::size_t kTailBytes = 1 << 16;

ProcessCommand loggerCommand(const std::string& lcm_url, const std::filesystem::path& file,
                             const std::filesystem::path& output_file) {
  // lcm-logger drops what comes while 30 messages wait for it, and a lockstep flight sends about
  // that many in a few milliseconds: it must run before those who make it wait.
  return {.name = "lcm-logger",
          .arguments = {"lcm-logger", "--quiet", "--flush-interval=20",
                        "--lcm-url=" + bus::withLargeReceiveBuffer(lcm_url), file.string()},
          .output_file = output_file,
          .ahead_of_others = true};
}

}  // namespace

Recorder::Recorder(bus::Bus& bus, const std::string& lcm_url, std::filesystem::path file,
                   const std::filesystem::path& output_file)
    : bus_(bus), file_(std::move(file)), process_(loggerCommand(lcm_url, file_, output_file)) {
  if (!waitUntilRecorded("start", kStartLimit_s)) {
    const auto status = process_.exited();
    const auto lines = process_.lastLines(1);
    throw core::StartupError(
        file_.string(), "lcm-logger", "a log that grows",
        fmt::format("{}{}", status ? status->describe() : "an empty file",
                    lines.empty() ? std::string() : " (" + lines.back() + ")"));
  }
}

std::string Recorder::close() {
  const bool recorded = waitUntilRecorded("end", kCloseLimit_s);
  const auto ended_before = process_.exited();
  const ExitStatus status = process_.stop(SIGINT, kLoggerExitLimit);
  if (ended_before) {
    return "lcm-logger ended before the flight did: " + ended_before->describe();
  }
  if (!recorded) {
    return fmt::format("lcm-logger was more than {:.0f} s behind", kCloseLimit_s);
  }
  return status.signal == SIGKILL ? "lcm-logger did not end and had to be killed" : "";
}

bool Recorder::waitUntilRecorded(const std::string& marker, double limit_s) {
  const std::string text = "roundabout fly " + marker;
  const double since_s = wallSeconds();
  while (!process_.exited() && wallSeconds() - since_s < limit_s) {
    roundabout_msgs::log_marker_t message;
    message.utime = wallTime();
    message.text = text;
    bus::publish(bus_, kMarkerChannel, message);
    if (fileTail(file_, kTailBytes).find(text) != std::string::npos) {
      return true;
    }
    process_.waitFor(kRepeat);
  }
  return false;
}

}  // namespace roundabout::cli
