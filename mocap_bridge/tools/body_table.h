#pragma once

#include <map>
#include <string>

#include "mocap_bridge/estimation/state_estimator.h"

namespace roundabout::mocap_bridge {

/// What `mocap watch` shows: every body of the last second or more, how well it comes, and which
/// vehicle it is.
class BodyTable {
 public:
  /// Rates count from here.
  void begin(core::Utime now) { last_text_ = now; }
  void add(const SourceFrame& frame);
  /// Rows of text. Ages are those at `now`, on the clock of the frames' exposures.
  std::string text(core::Utime now, const StateEstimator& estimator);

 private:
  struct Row {
    std::int64_t frames = 0;  // since the last text
    std::int64_t gaps = 0;    // times that it was not tracked, since the start
    bool tracked = false;
    core::Utime last_tracked = 0;
    double residual_m = 0.0;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  };

  std::map<std::string, Row> rows_;
  core::Utime last_text_ = 0;
  std::vector<double> latencies_ms_;  // exposure to arrival, since the last text
  std::int64_t frames_ = 0;
};

}  // namespace roundabout::mocap_bridge
