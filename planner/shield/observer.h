#pragma once

#include <vector>

#include "planner/shield/motion.h"

namespace roundabout::planner::shield {

/// Follows one vehicle, the own or another: what was measured of it and what it was told. Times are
/// in s, of one clock that does not go back.
class Observer {
 public:
  /// knows_commands: of a vehicle that is shielded. Without them its acceleration is taken from its
  /// velocity.
  explicit Observer(const MotionBounds& bounds, bool knows_commands = true);

  /// A measurement, world frame.
  void onState(double measured_s, const Eigen::Vector2d& position_m,
               const Eigen::Vector2d& velocity_mps, double heading_rad);

  /// A command that the vehicle was sent, or that was heard. Older than the last: ignored.
  void onCommand(double issued_s, const Eigen::Vector2d& velocity_mps, double valid_for_s);

  /// What is known now. Heights are the caller's to fill in. Valid until the next call.
  const Motion& motion(double now_s);

  void reset();

 private:
  struct Issued {
    double at_s;
    Eigen::Vector2d velocity_mps;
    double valid_for_s;
  };

  Eigen::Vector2d commandAt(double time_s, double delay_s) const;
  void estimateDrive(Pace pace, double step_s, double measured_s,
                     const Eigen::Vector2d& velocity_mps);
  void estimateAcceleration(double step_s, double measured_s, const Eigen::Vector2d& velocity_mps);

  MotionBounds bounds_;
  bool knows_commands_;
  bool seen_ = false;
  double measured_s_ = 0.0;
  std::vector<Issued> issued_;  // oldest first
  std::vector<SentCommand> sent_;
  Motion motion_;
};

}  // namespace roundabout::planner::shield
