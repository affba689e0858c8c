#pragma once

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "learning/evaluation/episode.h"

namespace roundabout::learning {

/// How an episode goes, whoever simulates it: who is done and when, and what comes of it.
class EpisodeRecord {
 public:
  using PositionOf = std::function<Eigen::Vector2d(std::size_t agent)>;

  struct Agent {
    double straight_time_s = 0.0;
    double time_s = 0.0;  ///< until it was done
    bool at_goal = false;
    bool collided = false;
    bool timed_out = false;

    bool done() const { return at_goal || collided || timed_out; }
  };

  /// trace: filled in as the episode goes; nullptr: nobody wants it.
  EpisodeRecord(const Rules& rules, const TestCase& test_case, Trace* trace);

  /// All begin to move to these goals, with new clocks.
  void beginLeg(std::span<const Eigen::Vector2d> goals_m, const PositionOf& position_of);
  /// After a planning step.
  void endStep(const PositionOf& position_of);
  void endLeg();

  std::size_t size() const { return agents_.size(); }
  Agent& operator[](std::size_t agent) { return agents_[agent]; }
  const Agent& operator[](std::size_t agent) const { return agents_[agent]; }
  /// Between the edges of two agents, or of an agent and an obstacle.
  void noteGap(double gap_m) { closest_m_ = std::min(closest_m_, gap_m); }
  void noteDecision() { ++decisions_; }
  void noteLayer(planner::shield::Layer layer) { ++layers_[static_cast<std::size_t>(layer)]; }

  bool allDone() const;
  Outcome outcome() const;
  EpisodeResult result() const;

 private:
  void trace(const PositionOf& position_of);

  const Rules& rules_;
  const TestCase& test_case_;
  Trace* trace_;
  std::vector<Agent> agents_;
  int steps_ = 0;
  int arrivals_ = 0;
  long decisions_ = 0;
  std::array<long, kShieldLayers> layers_{};
  double extra_time_s_ = 0.0;
  double closest_m_ = std::numeric_limits<double>::infinity();
};

/// Flies to the goals of a case one after the other, until a leg fails: fly(goals) runs one.
void flyLegs(const TestCase& test_case, const EpisodeRecord& record,
             const std::function<void(std::span<const Eigen::Vector2d> goals_m)>& fly);

}  // namespace roundabout::learning
