#include "planner/shield/two_lags.h"

#include <array>

#include "planner/shield/lanes.h"
#include "planner/shield/prediction.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

// GCC 12 takes the placeholder in its own header of AVX-512 for a use of nothing.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
[[gnu::noinline]] void shorten(LaneVectors& vectors, const Lanes& longest,
                               const Lanes& length_squared, const LaneMask& which) {
  const Lanes share = longest / sqrt(length_squared);
  where(which, vectors.x) = vectors.x * share;
  where(which, vectors.y) = vectors.y * share;
}
#pragma GCC diagnostic pop

[[gnu::always_inline]] inline LaneVectors limited(LaneVectors vectors, const Lanes& longest) {
  const Lanes length_squared = vectors.squaredNorm();
  const LaneMask too_long = length_squared > longest * longest;
  if (any_of(too_long)) [[unlikely]] {
    shorten(vectors, longest, length_squared, too_long);
  }
  return vectors;
}

/// Paths of vehicles with two lags, one in each lane: what follow() and wantedAcceleration() say,
/// side by side.
class TwoLags {
 public:
  explicit TwoLags(std::span<const Forecast> forecasts) : count_(forecasts.size()) {
    for (std::size_t lane = 0; lane < count_; ++lane) {
      setLane(lane, forecasts[lane], lane > 0 ? &forecasts[lane - 1] : nullptr);
    }
  }

  void run(std::span<Path> paths) {
    catchUp();
    std::array<std::size_t, kLanes> sizes{};
    LaneMask running(false);
    for (std::size_t lane = 0; lane < count_; ++lane) {
      running[lane] = true;
    }
    note(0);
    std::size_t size = 1;
    double time_s = 0.0;
    for (; size < Path::kMost - 1; ++size) {
      const LaneMask over =
          velocity_.squaredNorm() < kStanding_mps * kStanding_mps && time_s + 0.5 * kStep_s >= end_;
      if (any_of(running && over)) {
        finish(running && over, size, sizes);
        running = running && !over;
        if (none_of(running)) {
          break;
        }
      }
      for (int i = 0; i < kSubsteps; ++i) {
        obey(time_s + 0.5 * kStep_s);
        step(1.0);
        time_s += kStep_s;
      }
      note(size);
    }
    finish(running, size, sizes);
    for (std::size_t lane = 0; lane < count_; ++lane) {
      paths[lane].clear();
      for (std::size_t k = 0; k < sizes[lane]; ++k) {
        paths[lane].add({places_x_[k * kLanes + lane], places_y_[k * kLanes + lane]});
      }
      paths[lane].add(rests_[lane]);
    }
  }

 private:
  void setLane(std::size_t lane, const Forecast& forecast, const Forecast* last) {
    const Motion& motion = *forecast.motion;
    const MotionBounds bounds = forecast.bounds->at(forecast.pace);
    const Drive& drive = motion.drives[static_cast<std::size_t>(forecast.pace)];
    schedules_[lane] = Schedule(forecast, bounds.delay_s);
    until_s_[lane] = -kNever_s;
    age_s_[lane] = motion.age_s;
    lag_[lane] = bounds.lag_s;
    const bool same_lag =
        last != nullptr && last->bounds == forecast.bounds && last->pace == forecast.pace;
    share_[lane] = same_lag ? share_[lane - 1] : lagShare(bounds.inner_lag_s);
    resting_s_[lane] = bounds.lag_s + bounds.inner_lag_s;
    max_acceleration_[lane] = bounds.max_acceleration_mps2;
    // Finite, so that none of it is left in a step of no time.
    max_jerk_[lane] = std::min(bounds.max_jerk_mps3, std::numeric_limits<double>::max());
    end_[lane] = schedules_[lane].end();
    set(position_, lane, motion.position_world_m);
    set(velocity_, lane, motion.velocity_world_mps);
    set(acceleration_, lane, drive.acceleration_mps2);
    set(wanted_, lane, drive.wanted_mps2);
  }

  static void set(LaneVectors& vectors, std::size_t lane, const Vector2d& vector) {
    vectors.x[lane] = vector.x();
    vectors.y[lane] = vector.y();
  }

  // From when each was measured until now.
  void catchUp() {
    std::array<double, kLanes> time_s{};
    for (std::size_t lane = 0; lane < count_; ++lane) {
      time_s[lane] = -age_s_[lane];
    }
    for (;;) {
      Lanes part = 0.0;
      for (std::size_t lane = 0; lane < count_; ++lane) {
        if (time_s[lane] < -1e-9) {
          const double step_s = std::min(kStep_s, -time_s[lane]);
          set(command_, lane, schedules_[lane].at(time_s[lane] + 0.5 * step_s).velocity_mps);
          part[lane] = step_s / kStep_s;
          time_s[lane] += step_s;
        }
      }
      if (all_of(part == 0.0)) {
        return;
      }
      step(part);
    }
  }

  void obey(double time_s) {
    if (time_s < next_change_s_) {
      return;
    }
    next_change_s_ = kNever_s;
    for (std::size_t lane = 0; lane < count_; ++lane) {
      if (time_s >= until_s_[lane]) {
        const Schedule::Order order = schedules_[lane].at(time_s);
        set(command_, lane, order.velocity_mps);
        until_s_[lane] = order.until_s;
      }
      next_change_s_ = std::min(next_change_s_, until_s_[lane]);
    }
  }

  [[gnu::always_inline]] void step(const Lanes& part) {
    const Lanes step_s = part * kStep_s;
    const LaneVectors wanted = limited((command_ - velocity_) / lag_, max_acceleration_);
    wanted_ = wanted_ + limited(wanted - wanted_, max_jerk_ * step_s);
    acceleration_ = acceleration_ + (part * share_) * (wanted_ - acceleration_);
    velocity_ = velocity_ + step_s * acceleration_;
    position_ = position_ + step_s * velocity_;
  }

  void note(std::size_t k) {
    position_.x.copy_to(&places_x_[k * kLanes], std::experimental::element_aligned);
    position_.y.copy_to(&places_y_[k * kLanes], std::experimental::element_aligned);
  }

  // So many places, and the one where it comes to rest.
  void finish(const LaneMask& which, std::size_t size, std::array<std::size_t, kLanes>& sizes) {
    const LaneVectors rest = position_ + resting_s_ * velocity_;
    for (std::size_t lane = 0; lane < count_; ++lane) {
      if (which[lane]) {
        rests_[lane] = {rest.x[lane], rest.y[lane]};
        sizes[lane] = size;
      }
    }
  }

  std::size_t count_;
  std::array<Schedule, kLanes> schedules_;
  std::array<double, kLanes> until_s_{};  // of the command that is obeyed
  std::array<double, kLanes> age_s_{};
  double next_change_s_ = -kNever_s;
  Lanes lag_ = 1.0;
  Lanes share_ = 0.0;
  Lanes resting_s_ = 0.0;
  Lanes max_acceleration_ = 0.0;
  Lanes max_jerk_ = 0.0;
  Lanes end_ = 0.0;
  LaneVectors position_{0.0, 0.0};
  LaneVectors velocity_{0.0, 0.0};
  LaneVectors acceleration_{0.0, 0.0};
  LaneVectors wanted_{0.0, 0.0};
  LaneVectors command_{0.0, 0.0};
  std::array<Vector2d, kLanes> rests_;
  std::array<double, Path::kMost * kLanes> places_x_;
  std::array<double, Path::kMost * kLanes> places_y_;
};

}  // namespace

bool hasTwoLags(const MotionBounds& bounds) {
  return bounds.inner_lag_s > 0.0 && bounds.lag_s > 0.0 && !bounds.turns();
}

void predictTwoLags(std::span<const Forecast> forecasts, std::span<Path> paths) {
  TwoLags(forecasts).run(paths);
}

}  // namespace roundabout::planner::shield
