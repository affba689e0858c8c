#pragma once

#include <array>
#include <limits>
#include <span>

#include <Eigen/Core>

namespace roundabout::planner::shield {

/// How a vehicle follows its velocity commands; every number an upper bound. With the defaults it
/// does at once what it is told.
struct MotionBounds {
  double delay_s = 0.0;      ///< from issuing a command to its first effect
  double lag_s = 0.0;        ///< velocity error / wanted acceleration
  double inner_lag_s = 0.0;  ///< of the acceleration behind the wanted one (attitude)
  double max_acceleration_mps2 = std::numeric_limits<double>::infinity();
  /// Finite: it drives along its heading, by the share of the command that points there, and turns
  /// this fast.
  double max_turn_rate_radps = std::numeric_limits<double>::infinity();

  bool turns() const { return std::isfinite(max_turn_rate_radps); }
};

/// A velocity command that was issued. World frame.
struct SentCommand {
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double age_s = 0.0;  ///< since it was issued, now
  /// After it was issued; then the vehicle brakes by itself. Longer than its delay.
  double valid_for_s = 0.0;
};

/// What is known of a vehicle's motion, and so of its next seconds. World frame.
struct Motion {
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  double lowest_m = 0.0;   ///< of the heights at which it may be until it stands
  double highest_m = 0.0;  ///< the same
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  Eigen::Vector2d acceleration_world_mps2 = Eigen::Vector2d::Zero();  ///< zero if not known
  double heading_world_rad = 0.0;
  double age_s = 0.0;                       ///< since this was measured, now
  std::span<const SentCommand> commands{};  ///< the last few, oldest first; older than 1 s: no use
};

/// Where a vehicle's centre may be from now until it stands, if it gets no further command.
class Path {
 public:
  static constexpr double kStep_s = 0.05;
  static constexpr std::size_t kMost = 48;

  void clear() { size_ = 0; }
  void add(const Eigen::Vector2d& point_world_m) {
    if (size_ < kMost) {
      points_[size_++] = point_world_m;
    }
  }
  std::span<const Eigen::Vector2d> points() const { return {points_.data(), size_}; }

 private:
  std::array<Eigen::Vector2d, kMost> points_;
  std::size_t size_ = 0;
};

/// Which of the commands of a motion arrive.
enum class Arrival { kAll, kLastIsLost };

/// The path from now on, in steps of Path::kStep_s: commands that were issued, each until the next
/// or until it expires, then braking. `next`: one more that is issued now.
void predict(const Motion& motion, const MotionBounds& bounds, Arrival arrival,
             const SentCommand* next, Path& path);

/// How far a unit velocity command that is issued now and expires after hold_s has carried a
/// vehicle without a limit on acceleration, after each step of a path. s.
std::array<double, Path::kMost> reachOf(const MotionBounds& bounds, double hold_s);

}  // namespace roundabout::planner::shield
