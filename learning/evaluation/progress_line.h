#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

namespace roundabout::learning {

inline std::string timeText(double seconds) {
  return seconds < 90.0 ? fmt::format("{:.0f} s", seconds)
                        : fmt::format("{:.1f} min", seconds / 60);
}

/// How far a long computation is, on the standard error: one line on a terminal, else a line every
/// ten seconds.
class ProgressLine {
 public:
  /// first: of the items, already done when it begins. items: "cases".
  ProgressLine(std::size_t first, std::size_t count, std::string items)
      : first_(first), count_(count), items_(std::move(items)) {}

  void show(std::size_t done, const std::string& what) {
    const bool last = done == count_;
    const Seconds since_shown = Clock::now() - shown_;
    if (!last && since_shown.count() < (terminal_ ? 0.2 : 10.0)) {
      return;
    }
    shown_ = Clock::now();
    const double spent_s = Seconds(shown_ - begin_).count();
    const double left_s = spent_s * static_cast<double>(count_ - done) /
                          static_cast<double>(std::max<std::size_t>(done - first_, 1));
    fmt::print(stderr, "{}{} of {} {}, {}, {} left{}", terminal_ ? "\r\033[K" : "", done, count_,
               items_, what, timeText(left_s), terminal_ && !last ? "" : "\n");
  }

  /// Makes way for other lines on the terminal, until it is shown again.
  void hide() const {
    if (terminal_ && shown_ != begin_) {
      fmt::print(stderr, "\r\033[K");
      std::fflush(stderr);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  std::size_t first_;
  std::size_t count_;
  std::string items_;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point shown_ = begin_;
};

}  // namespace roundabout::learning
