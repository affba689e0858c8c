#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mocap_bridge/estimation/state_estimator.h"

namespace roundabout::mocap_bridge {

/// What `mocap watch` shows: every body of the last ten seconds, how well it comes, and which
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
    std::string name;
    std::int64_t frames = 0;  // since the last text
    std::int64_t gaps = 0;    // times that it was not tracked or not in the frame, since the start
    std::int64_t in_frame = 0;  // the last that it was in, counted
    bool tracked = false;
    core::Utime last_streamed = 0;
    core::Utime last_tracked = 0;
    double residual_m = 0.0;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  };
  // The streaming id; of bodies without one the name.
  using Key = std::pair<std::int64_t, std::string>;

  std::string rowText(const Key& key, const Row& row, core::Utime now, double passed_s,
                      const StateEstimator& estimator) const;

  std::map<Key, Row> rows_;
  core::Utime last_text_ = 0;
  std::vector<double> latencies_ms_;  // exposure to arrival, since the last text
  std::int64_t frames_ = 0;           // since the last text
  std::int64_t all_frames_ = 0;
};

}  // namespace roundabout::mocap_bridge
