#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "common/core/agent.h"

namespace roundabout::planner {

/// One of the actions that a policy chooses from.
struct DiscreteAction {
  double speed_fraction = 0.0;      ///< of the preferred speed
  double heading_change_rad = 0.0;  ///< counter-clockwise
};

/// What a policy chose.
struct Decision {
  double speed_mps = 0.0;           ///< >= 0, at most the ego's preferred speed; NaN: no decision
  double heading_change_rad = 0.0;  ///< added to the ego's heading; counter-clockwise
  int action = -1;                  ///< index into the policy's action table; -1: it has none
  double value = std::numeric_limits<double>::quiet_NaN();  ///< of the critic; NaN: it has none
  std::span<const float>
      action_probabilities{};                 ///< valid until the next query; empty: it has none
  std::span<const DiscreteAction> actions{};  ///< the action table; empty: it has none
  int neighbours_used = 0;
};

/// Maps one agent's situation to a speed and a change of heading. One object serves one agent: it
/// may keep memory.
class Policy {
 public:
  Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  virtual ~Policy() = default;

  /// All inputs are finite; others may be empty, in any order. Called once per planning tick.
  /// Deterministic; allocates nothing after the first call with as many others and obstacles.
  virtual Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) = 0;

  /// Whether decide() needs a scan. Without one such a policy stands still.
  virtual bool needsScan() const { return false; }

  /// Whether decide() keeps off obstacles. Others may not fly where there are some.
  virtual bool avoidsObstacles() const { return false; }

  /// Another one for another agent: shares parameters with this one, remembers nothing.
  virtual std::unique_ptr<Policy> twin() const = 0;

  /// Forgets what was remembered of earlier calls: a new flight begins.
  virtual void reset() {}

  /// Name in the table of policies.
  virtual std::string_view name() const = 0;
};

}  // namespace roundabout::planner
