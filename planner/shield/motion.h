#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include <Eigen/Core>

namespace roundabout::planner::shield {

/// As a vehicle's bounds say, or with all of their reserve used up.
enum class Pace : std::int8_t { kAssumed = 0, kSlowest = 1 };

/// How a vehicle follows its velocity commands. With the defaults it does at once what it is told.
struct MotionBounds {
  double delay_s = 0.0;      ///< from issuing a command to its first effect
  double lag_s = 0.0;        ///< velocity error / wanted acceleration
  double inner_lag_s = 0.0;  ///< of the acceleration behind the wanted one (attitude)
  double reserve = 1.0;      ///< delay and lags are those, or up to this many times as long
  double max_acceleration_mps2 = std::numeric_limits<double>::infinity();
  double max_jerk_mps3 = std::numeric_limits<double>::infinity();  ///< of the wanted acceleration
  /// Finite: it drives along its heading, by the share of the command that points there, and turns
  /// this fast.
  double max_turn_rate_radps = std::numeric_limits<double>::infinity();

  bool turns() const { return std::isfinite(max_turn_rate_radps); }

  /// Delay and lags with or without the reserve.
  MotionBounds at(Pace pace) const;
};

/// A velocity command that was issued. World frame.
struct SentCommand {
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double age_s = 0.0;  ///< since it was issued, now
  /// After it was issued; then the vehicle brakes by itself. Longer than its delay.
  double valid_for_s = 0.0;
};

/// What drives a vehicle behind its inner lag. World frame.
struct Drive {
  Eigen::Vector2d acceleration_mps2 = Eigen::Vector2d::Zero();  ///< zero if not known
  Eigen::Vector2d wanted_mps2 = Eigen::Vector2d::Zero();        ///< within the limits of its jerk
};

/// What is known of a vehicle's motion, and so of its next seconds. World frame.
struct Motion {
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  double lowest_m = 0.0;   ///< of the heights at which it may be until it stands
  double highest_m = 0.0;  ///< the same
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  std::array<Drive, 2> drives{};  ///< by Pace
  double heading_world_rad = 0.0;
  double age_s = 0.0;                       ///< since this was measured, now
  std::span<const SentCommand> commands{};  ///< the last few, oldest first; older than 1 s: no use
};

/// Where a vehicle's centre may be from now until it stands, if it gets no further command.
class Path {
 public:
  static constexpr double kStep_s = 0.05;
  static constexpr std::size_t kMost = 64;

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

/// A path to predict. All that it points to outlives the prediction.
struct Forecast {
  const Motion* motion = nullptr;
  const MotionBounds* bounds = nullptr;
  Pace pace = Pace::kAssumed;
  Arrival arrival = Arrival::kAll;
  const SentCommand* next = nullptr;  ///< one more command, that is issued now
};

/// The path from now on, in steps of Path::kStep_s: commands that were issued, each until the next
/// or until it expires, then braking.
void predict(const Forecast& forecast, Path& path);

/// The same for several, paths[i] for forecasts[i]; faster than one after the other, and equal to
/// that bit for bit.
void predict(std::span<const Forecast> forecasts, std::span<Path> paths);

/// The limited acceleration that a velocity error asks for.
Eigen::Vector2d wantedAcceleration(const Eigen::Vector2d& error_mps, const MotionBounds& bounds);

/// A step of what drives a vehicle.
void follow(const Eigen::Vector2d& wanted_mps2, const MotionBounds& bounds, double share,
            double step_s, Drive& drive);

/// How far a unit velocity command that is issued now and expires after hold_s has carried a
/// vehicle without a limit on acceleration, after each step of a path. s.
std::array<double, Path::kMost> reachOf(const MotionBounds& bounds, Pace pace, double hold_s);

}  // namespace roundabout::planner::shield
