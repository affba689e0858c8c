#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "common/core/random.h"
#include "planner/shield/observer.h"
#include "planner/shield/shield.h"

namespace roundabout::planner::shield {

/// What a crowd's world is like: written apart from the shield's own prediction, and stepped finer.
struct CrowdSettings {
  double half_side_m = 3.0;  ///< starts and goals lie in a square of twice this
  int vehicles = 6;
  double period_s = 0.1;
  bool ideal = false;  ///< all decide at once on the truth, and do at once what they decide
  MotionBounds truth;  ///< how vehicles really are
  MotionBounds assumed;
  double state_age_s = 0.02;
  double position_noise_m = 0.001;
  double velocity_noise_mps = 0.02;
  double loss = 0.05;             ///< of states, and of commands by each who should hear them
  double room_half_side_m = 0.0;  ///< 0: no walls
  std::vector<core::Polygon> obstacles{};  ///< convex
};

/// Shielded vehicles that fly what somebody else wants.
class Crowd {
 public:
  struct Vehicle {
    Eigen::Vector2d position_m, velocity_mps{0, 0}, acceleration_mps2{0, 0};
    Eigen::Vector2d goal_m;
    double heading_rad = 0.0;
    double radius_m, top_speed_mps;
    double next_decision_s;
    struct OnTheWay {
      double from_s, until_s;
      Eigen::Vector2d velocity_mps;
    };
    std::deque<OnTheWay> commands;
    std::unique_ptr<Shield> shield;
    std::vector<Observer> observers;  // of everybody, the own included
  };
  /// What vehicle i wants.
  using Want = std::function<Eigen::Vector2d(const Crowd&, std::size_t i)>;

  Crowd(const CrowdSettings& settings, const ShieldParameters& parameters, std::uint64_t seed);

  /// Runs for so long; returns the number of decisions.
  long run(double duration_s, const Want& want);

  const std::vector<Vehicle>& vehicles() const { return vehicles_; }
  core::RandomStream& random() { return random_; }
  double closestGapM() const { return closest_m_; }
  /// Between any vehicle and a wall or an obstacle.
  double closestStaticM() const { return closest_static_m_; }

 private:
  void place();
  void decide(std::size_t i, const Want& want);
  void observe();
  void move(double step_s);
  void drive(Vehicle& each, const Eigen::Vector2d& command, double step_s) const;
  void noteGaps();

  CrowdSettings settings_;
  ShieldParameters parameters_;
  core::RandomStream random_;
  std::vector<Vehicle> vehicles_;
  double time_s_ = 1.0;
  bool observed_ = false;  // everybody has been seen once
  double closest_m_ = 1e9;
  double closest_static_m_ = 1e9;
  std::vector<Wall> walls_;
};

/// Straight at the nearest other vehicle, at top speed.
Eigen::Vector2d attack(const Crowd& crowd, std::size_t i);

}  // namespace roundabout::planner::shield
