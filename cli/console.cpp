#include "cli/console.h"

#include <cstdio>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "cli/wall_clock.h"

namespace roundabout::cli {

namespace {

constexpr double kTerminalPeriod_s = 0.1;
constexpr double kFilePeriod_s = 5.0;

}  // namespace

Console::Console() : terminal_(isatty(STDOUT_FILENO) == 1), last_progress_s_(wallSeconds()) {}

Console::~Console() {
  if (live_line_) {
    fmt::print("\n");
  }
}

void Console::say(const std::string& line) {
  clear();
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void Console::progress(const std::string& line) {
  if (!progressDue()) {
    return;
  }
  last_progress_s_ = wallSeconds();
  if (!terminal_) {
    say(line);
    return;
  }
  clear();
  fmt::print("{}", line);
  std::fflush(stdout);
  live_line_ = true;
}

bool Console::progressDue() const {
  return wallSeconds() - last_progress_s_ >= (terminal_ ? kTerminalPeriod_s : kFilePeriod_s);
}

void Console::clear() {
  if (live_line_) {
    fmt::print("\r\033[K");
    live_line_ = false;
  }
}

}  // namespace roundabout::cli
