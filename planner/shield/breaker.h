#pragma once

#include <optional>
#include <vector>

#include "planner/shield/scene.h"
#include "planner/shield/way_round.h"

namespace roundabout::planner::shield {

/// Takes over when a vehicle does not get on: a sampling planner along the shortest way round what
/// stands, leaning more and more to the right while somebody who moves is in the way.
class Breaker {
 public:
  explicit Breaker(const ShieldParameters& parameters) : parameters_(parameters) { reset(); }

  struct Plan {
    Eigen::Vector2d velocity_mps;
    bool asks_for_way;
  };

  /// Once per decision. Nothing: the policy goes on.
  std::optional<Plan> update(const Ego& ego, const Scene& scene, const Statics& statics,
                             double now_s);

  void reset();

 private:
  void noteProgress(const Ego& ego, const Scene& scene);
  void begin();
  bool mayEnd(const Ego& ego, const Scene& scene) const;
  void replan(const Ego& ego, const Scene& scene, const Statics& statics);
  void lean(const Scene& scene, const Eigen::Vector2d& direction, double preferred_mps);
  Eigen::Vector2d sample(const Scene& scene, const Eigen::Vector2d& desired_mps,
                         double preferred_mps) const;

  const ShieldParameters& parameters_;
  std::optional<double> last_s_;
  double step_s_ = 0.0;
  double last_distance_m_ = 0.0;
  double closest_m_ = 0.0;  // to the goal, ever
  double progress_ = 1.0;   // filtered, share of the speed that is expected
  double expected_mps_ = 1.0;

  bool active_ = false;
  int entries_ = 0;
  double active_s_ = 0.0;
  double free_s_ = 0.0;  // for so long the way has been free
  double record_m_ = 0.0;
  double lean_rad_ = 0.0;

  WayRound way_round_;
  std::vector<Hindrance> hindrances_;
  std::vector<Eigen::Vector2d> way_;
  bool has_way_ = true;
  double since_plan_s_ = 0.0;
};

/// Round vehicles that stand and round obstacles.
void collectHindrances(const Ego& ego, const Scene& scene, const Statics& statics,
                       std::vector<Hindrance>& hindrances);

}  // namespace roundabout::planner::shield
