#pragma once

#include <numbers>

#include "common/core/agent.h"
#include "planner/policies/drl_maca/network.h"

namespace roundabout::planner {

/// What the network's beams cover, as in the wrapper that the GA3C-CADRL paper used
/// (gym-collision-avoidance, LaserScanSensor): from straight right to straight left, both included.
inline constexpr double kDrlMacaFieldOfViewRad = std::numbers::pi;
/// A beam that meets nothing until here says so.
inline constexpr double kDrlMacaMaxRangeM = 6.0;

/// The last three scans as the network sees them.
class ScanStack {
 public:
  /// Adds a scan; the first one fills the stack. For each of the network's beams the nearest
  /// measured one counts; what says that it hit nothing, or is infinite, is 6 m away. A beam that
  /// is NaN was not measured: the one before it stands. Returns false, and changes nothing, if the
  /// scan does not cover the field of view or more than a tenth of it was not measured.
  bool push(const core::RangeScan& scan);

  void clear() { filled_ = false; }
  /// Oldest first.
  const DrlMacaNetwork::Scans& scans() const { return scans_; }

 private:
  DrlMacaNetwork::Scans scans_{};
  bool filled_ = false;
};

}  // namespace roundabout::planner
