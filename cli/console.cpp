#include "cli/console.h"

#include <csignal>
#include <cstdio>

#include <fcntl.h>
#include <unistd.h>

#include "cli/wall_clock.h"

namespace roundabout::cli {

namespace {

constexpr double kTerminalPeriod_s = 0.1;
constexpr double kFilePeriod_s = 5.0;

void write(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

void standWithoutTerminal() {
  std::signal(SIGPIPE, SIG_IGN);
  int lowest_free = open("/dev/null", O_RDWR);
  while (lowest_free >= 0 && lowest_free <= STDERR_FILENO) {
    lowest_free = open("/dev/null", O_RDWR);
  }
  close(lowest_free);
}

Console::Console() : terminal_(isatty(STDOUT_FILENO) == 1), last_progress_s_(wallSeconds()) {}

Console::~Console() {
  if (live_line_) {
    write("\n");
  }
}

void Console::say(const std::string& line) {
  clear();
  write(line + "\n");
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
  write(line);
  live_line_ = true;
}

bool Console::progressDue() const {
  return wallSeconds() - last_progress_s_ >= (terminal_ ? kTerminalPeriod_s : kFilePeriod_s);
}

void Console::clear() {
  if (live_line_) {
    write("\r\033[K");
    live_line_ = false;
  }
}

}  // namespace roundabout::cli
