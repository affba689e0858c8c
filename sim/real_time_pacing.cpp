#include "sim/real_time_pacing.h"

#include <cerrno>
#include <ctime>
#include <string>

#include <spdlog/spdlog.h>

namespace roundabout::sim {

namespace {

using Micros = std::chrono::microseconds;
using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC in libstdc++

// Before a frame is due: enough to read the commands, step the world and make the frame.
constexpr Micros kPreparation{1000};
constexpr Micros kTooLate{100'000};

void sleepUntil(Clock::time_point deadline) {
  const auto since_boot =
      std::chrono::duration_cast<std::chrono::nanoseconds>(deadline.time_since_epoch()).count();
  const timespec time{since_boot / 1'000'000'000, since_boot % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

core::Utime wallClock() {
  return std::chrono::duration_cast<Micros>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

RealTimePacing::RealTimePacing(bus::Bus& bus) : bus_(bus) {}

core::Utime RealTimePacing::firstUtime(double frame_rate_hz) {
  const core::Utime interval = core::toUtime(1.0 / frame_rate_hz);
  return (wallClock() / interval + 1) * interval;
}

void RealTimePacing::run(SimNode& node, const std::function<bool()>& stop) {
  // The wall clock may be set while we fly: it gives the epoch, the steady clock the pace.
  const auto epoch = Clock::now() - Micros(wallClock());
  bool late = false;
  while (!node.finished() && !stop()) {
    const auto deadline = epoch + Micros(node.nextFrameUtime() + node.latencyUs());
    sleepUntil(deadline - kPreparation);
    bus_.handle(std::chrono::milliseconds(0));
    node.advance();
    sleepUntil(deadline);
    const bool too_late = Clock::now() - deadline > kTooLate;
    if (too_late) {
      node.skipFrame();
    } else {
      node.publishFrame();
    }
    if (too_late && !late) {
      spdlog::warn("more than {} ms late: frames are skipped", kTooLate.count() / 1000);
    }
    late = too_late;
  }
}

}  // namespace roundabout::sim
