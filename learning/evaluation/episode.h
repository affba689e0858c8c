#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "learning/evaluation/rules.h"
#include "learning/evaluation/test_case.h"
#include "planner/policy.h"
#include "planner/shield/shield.h"

namespace roundabout::learning {

/// Of one agent, and of a case.
enum class Outcome { kAllAtGoal, kCollision, kStuck };

/// "all_at_goal", "collision", "stuck"
const char* nameOf(Outcome outcome);

inline constexpr std::size_t kShieldLayers = 6;

struct EpisodeResult {
  Outcome outcome = Outcome::kStuck;
  int steps = 0;                      ///< until the last agent was done
  double mean_extra_time_s = 0.0;     ///< over the agents that arrived; NaN: none did
  double closest_separation_m = 0.0;  ///< between edges of agents and obstacles, over all steps
  long decisions = 0;                 ///< policy queries
  /// Decisions by the layer of the shield that changed them, in the order of
  /// planner::shield::Layer.
  std::array<long, kShieldLayers> layers{};
};

/// Where an agent was after a step.
struct TracePoint {
  Eigen::Vector2d position_m;
  bool done;
  bool collided;
};

/// All agents on the way to one set of goals, step by step from the start: leg[step][agent].
using Leg = std::vector<std::vector<TracePoint>>;
/// One leg for each set of goals that was flown to.
using Trace = std::vector<Leg>;

/// Who flies the agents of a case.
struct Crew {
  std::span<const std::unique_ptr<planner::Policy>> policies;
  std::span<const std::uint8_t> shielded{};  ///< 1: behind the shield; empty: nobody is

  bool isShielded(std::size_t agent) const {
    return agent < shielded.size() && shielded[agent] != 0;
  }
};

/// Runs one case under rules. crew.policies[i] serves agent i and is reset first. The result is a
/// function of rules, case and crew alone. If trace is given, it is filled in.
EpisodeResult runEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew,
                         Trace* trace = nullptr);

}  // namespace roundabout::learning
