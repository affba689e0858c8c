#pragma once

#include <array>
#include <optional>
#include <utility>

#include "common/core/time.h"

namespace roundabout::mocap_bridge {

/// Maps another machine's clock to the local one, from pairs of readings that are late by a delay
/// of unknown size. In every second the reading with the smallest delay counts; a line through
/// those of the last 16 s gives offset and skew (at most 500 ppm). The map moves by at most 1 ms a
/// second, so that intervals between mapped stamps stay those of the other clock, unless it is
/// wrong by more than 20 ms. Arrivals that are later than that were held up: nothing is learned
/// from them, unless all of a second are, for then the other clock stood still or was set back.
/// Three in a row that are earlier, or an echo that is off by more than its round trip explains:
/// the other clock was set, and everything is learned anew.
class ClockMap {
 public:
  /// Readings of one moment: the other clock when it answered, the local one at the middle between
  /// question and answer, and the time from question to answer.
  void addEcho(double remote_s, core::Utime local_middle, double round_trip_s);
  /// A stamp of the other clock and when it arrived. The map then contains the shortest delay.
  void addArrival(double remote_s, core::Utime local_arrival);

  bool ready() const { return samples_ >= kEnough; }
  /// Precondition: ready().
  core::Utime toLocal(double remote_s) const;
  /// Relative rate of the clocks, local seconds for a second of the other, minus one.
  double skew() const { return skew_; }
  /// us between the first and the last reading.
  core::Utime span() const { return samples_ == 0 ? 0 : last_local_ - origin_local_; }
  void reset() { *this = ClockMap(); }

 private:
  static constexpr int kEnough = 3;
  static constexpr std::size_t kBuckets = 16;

  struct Bucket {
    double remote_s = 0.0;
    double offset_s = 0.0;  // local minus remote, each since its origin
    double badness_s = 0.0;
    std::int64_t second = -1;
  };

  /// A row of late arrivals and the least late among them.
  struct LateRow {
    core::Utime first = 0;
    core::Utime last = 0;
    double least_s = 0.0;
    double remote_s = 0.0;
    core::Utime local = 0;
  };

  void addLate(double remote_s, core::Utime local, double late_s);
  void addEarly(double remote_s, core::Utime local);
  void add(double remote_s, core::Utime local, std::optional<double> badness_s);
  void fit(double remote_s);

  double origin_remote_s_ = 0.0;
  core::Utime origin_local_ = 0;
  core::Utime last_local_ = 0;
  std::optional<LateRow> late_;
  std::array<std::pair<double, core::Utime>, kEnough> early_{};  // stamps and arrivals, in a row
  std::size_t earlies_ = 0;
  std::array<Bucket, kBuckets> buckets_;
  int samples_ = 0;
  double anchor_remote_s_ = 0.0;
  double anchor_offset_s_ = 0.0;
  double skew_ = 0.0;
};

}  // namespace roundabout::mocap_bridge
