#include "mocap_bridge/sources/clock_map.h"

#include <algorithm>
#include <cmath>

namespace roundabout::mocap_bridge {

namespace {

constexpr double kLargestSkew = 500e-6;
constexpr double kSlew = 1e-3;  // s of correction in a second
// Two crystals do not come apart so far: the other clock was set, or its machine restarted.
constexpr double kStep_s = 0.02;
constexpr core::Utime kLateForGood = core::kMicrosPerSecond;
constexpr core::Utime kLateGap = kLateForGood / 4;
constexpr int kEnoughForSkew = 4;

}  // namespace

void ClockMap::addEcho(double remote_s, core::Utime local_middle, double round_trip_s) {
  add(remote_s, local_middle, round_trip_s);
}

void ClockMap::addArrival(double remote_s, core::Utime local_arrival) {
  add(remote_s, local_arrival, std::nullopt);
}

void ClockMap::add(double remote_s, core::Utime local, std::optional<double> badness_s) {
  if (!std::isfinite(remote_s)) {
    return;
  }
  if (samples_ == 0) {
    origin_remote_s_ = remote_s;
    origin_local_ = local;
  }
  const double since_s = core::toSeconds(local - origin_local_);
  const double remote = remote_s - origin_remote_s_;
  const double offset_s = since_s - remote;
  const double late_s = offset_s - anchor_offset_s_ - skew_ * (remote - anchor_remote_s_);
  last_local_ = local;
  if (ready() && !badness_s && late_s > kStep_s) {
    earlies_ = 0;
    addLate(remote_s, local, late_s);
    return;
  }
  late_.reset();
  if (ready() && !badness_s && late_s < -kStep_s) {
    addEarly(remote_s, local);
    return;
  }
  earlies_ = 0;
  if (samples_ > 0 && badness_s && std::abs(late_s) > kStep_s + 0.5 * *badness_s) {
    reset();
    add(remote_s, local, badness_s);
    return;
  }
  const auto second = static_cast<std::int64_t>(std::floor(since_s));
  Bucket& bucket = buckets_[static_cast<std::size_t>(std::max<std::int64_t>(second, 0)) % kBuckets];
  const double badness = badness_s.value_or(offset_s);
  if (bucket.second != second || badness < bucket.badness_s) {
    bucket = {remote, offset_s, badness, second};
  }
  ++samples_;
  fit(remote);
}

void ClockMap::addLate(double remote_s, core::Utime local, double late_s) {
  if (!late_ || local - late_->last > kLateGap) {
    late_ = {local, local, late_s, remote_s, local};
  }
  late_->last = local;
  if (late_s <= late_->least_s) {
    late_ = {late_->first, local, late_s, remote_s, local};
  }
  if (local - late_->first >= kLateForGood) {
    const LateRow row = *late_;
    reset();
    addArrival(row.remote_s, row.local);
    addArrival(remote_s, local);
  }
}

void ClockMap::addEarly(double remote_s, core::Utime local) {
  early_[earlies_++] = {remote_s, local};
  if (earlies_ == early_.size()) {
    const auto row = early_;
    reset();
    for (const auto& [stamp_s, arrival] : row) {
      addArrival(stamp_s, arrival);
    }
  }
}

void ClockMap::fit(double remote_s) {
  const double newest = std::max_element(buckets_.begin(), buckets_.end(), [](auto& a, auto& b) {
                          return a.second < b.second;
                        })->second;
  double count = 0.0;
  double mean_remote = 0.0;
  double mean_offset = 0.0;
  const auto used = [&](const Bucket& bucket) {
    return bucket.second >= 0 && static_cast<double>(bucket.second) > newest - kBuckets;
  };
  for (const Bucket& bucket : buckets_) {
    if (used(bucket)) {
      count += 1.0;
      mean_remote += bucket.remote_s;
      mean_offset += bucket.offset_s;
    }
  }
  if (count == 0.0) {
    return;
  }
  mean_remote /= count;
  mean_offset /= count;
  double spread = 0.0;
  double product = 0.0;
  for (const Bucket& bucket : buckets_) {
    if (used(bucket)) {
      spread += (bucket.remote_s - mean_remote) * (bucket.remote_s - mean_remote);
      product += (bucket.remote_s - mean_remote) * (bucket.offset_s - mean_offset);
    }
  }
  const double applied = anchor_offset_s_ + skew_ * (remote_s - anchor_remote_s_);
  const double passed_s = std::max(remote_s - anchor_remote_s_, 0.0);
  skew_ = count >= kEnoughForSkew && spread > 1.0
              ? std::clamp(product / spread, -kLargestSkew, kLargestSkew)
              : 0.0;
  const double target = mean_offset + skew_ * (remote_s - mean_remote);
  const bool settled = samples_ > kEnough && std::abs(target - applied) < kStep_s;
  anchor_offset_s_ =
      settled ? applied + std::clamp(target - applied, -kSlew * passed_s, kSlew * passed_s)
              : target;
  anchor_remote_s_ = remote_s;
}

core::Utime ClockMap::toLocal(double remote_s) const {
  const double remote = remote_s - origin_remote_s_;
  return origin_local_ +
         core::toUtime(remote + anchor_offset_s_ + skew_ * (remote - anchor_remote_s_));
}

}  // namespace roundabout::mocap_bridge
