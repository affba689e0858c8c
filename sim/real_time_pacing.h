#pragma once

#include <chrono>
#include <functional>

#include "common/bus/bus.h"
#include "common/core/time.h"
#include "sim/sim_node.h"

namespace roundabout::sim {

/// Publishes every frame at its utime plus the mocap latency, by the wall clock.
class RealTimePacing {
 public:
  explicit RealTimePacing(bus::Bus& bus);

  /// utime for a first frame that is due now: wall clock, on the frame grid.
  static core::Utime firstUtime(double frame_rate_hz);

  /// Publishes frames until the node is finished or stop() is true. Frames that are late go out at
  /// once; those that are late by more than 100 ms are skipped.
  void run(SimNode& node, const std::function<bool()>& stop);

 private:
  bus::Bus& bus_;
};

}  // namespace roundabout::sim
