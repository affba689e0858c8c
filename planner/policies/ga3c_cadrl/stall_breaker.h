#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "common/core/agent.h"
#include "planner/policies/ga3c_cadrl/network.h"

namespace roundabout::planner {

/// Gets an agent out of a place where the most probable action leads nowhere: to stand, to turn on
/// the spot, to circle. A network that learned by drawing its actions does not know such places,
/// and the arg max never leaves them. From the moment it has stalled until it makes progress an
/// agent draws its actions, and never the one that it would stand still with. What is drawn
/// depends on where it began and on what it saw since, on nothing else.
class StallBreaker {
 public:
  explicit StallBreaker(const StallSettings& settings) : settings_(settings) {}

  /// For a new mission.
  void reset() { watch_.reset(); }

  /// best_action, or another one. Once for each decision.
  int choose(const core::EgoAgent& ego, std::span<const float> probabilities, int best_action);

 private:
  struct Watch {
    Eigen::Vector2d goal_world_m;
    double nearest_m;  // by the way that is left, or the distance
    double last_m;
    int decisions_since = 0;
    std::uint64_t chance;  // state of a generator that allocates nothing
  };

  int draw(std::span<const float> probabilities);

  StallSettings settings_;
  std::optional<Watch> watch_;
};

}  // namespace roundabout::planner
