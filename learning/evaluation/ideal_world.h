#pragma once

#include <span>
#include <vector>

#include "common/core/agent.h"
#include "learning/evaluation/episode_record.h"

namespace roundabout::learning {

/// What an agent does in one planning step, in the single precision in which the published
/// environment passes it on.
struct IdealAction {
  float speed_mps = 0.0F;
  float heading_change_rad = 0.0F;
};

/// As the published environment wraps angles: an angle within a turn of [-pi, pi), and one that
/// needs no turn keeps its last bit.
double wrappedOnce(double angle_rad);

/// World frame, of an agent that had this heading before.
Eigen::Vector2d velocityOf(const IdealAction& action, double heading_rad);

/// Agents that do at once what is decided for them, as in the published environment. It knows no
/// policies: evaluation and training step the same world. rules and test_case outlive it.
class IdealWorld {
 public:
  IdealWorld(const Rules& rules, const TestCase& test_case, Trace* trace = nullptr);
  IdealWorld(const IdealWorld&) = delete;
  IdealWorld& operator=(const IdealWorld&) = delete;

  /// All begin to move to these goals: velocities and clocks start anew.
  void beginLeg(std::span<const Eigen::Vector2d> goals_m);
  void endLeg() { record_.endLeg(); }

  /// All turn and move at once; then it is judged who arrived, collided or got stuck. actions: one
  /// for each agent; those of agents that are done count for nothing.
  void step(std::span<const IdealAction> actions);

  std::size_t size() const { return agents_.size(); }
  const core::EgoAgent& agent(std::size_t i) const { return agents_[i]; }
  bool done(std::size_t i) const { return record_[i].done(); }
  /// Everybody else, valid until the next call. Ids are places in the case.
  std::span<const core::OtherAgent> othersOf(std::size_t i);

  EpisodeRecord& record() { return record_; }
  const EpisodeRecord& record() const { return record_; }

 private:
  void move(std::size_t i, const IdealAction& action);
  void collide();
  template <class Visit>
  void forAllPairs(Visit visit);
  template <class Visit>
  void forAllBesideObstacles(Visit visit);

  const Rules& rules_;
  std::span<const core::Polygon> obstacles_;
  EpisodeRecord record_;
  std::vector<core::EgoAgent> agents_;
  std::vector<double> time_left_s_;  // until an agent counts as stuck
  std::vector<core::OtherAgent> others_;
  const EpisodeRecord::PositionOf position_of_ = [this](std::size_t i) {
    return agents_[i].position_world_m;
  };
};

}  // namespace roundabout::learning
