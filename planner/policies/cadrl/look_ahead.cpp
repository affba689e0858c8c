#include "planner/policies/cadrl/look_ahead.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "planner/policies/cadrl/encounter.h"
#include "planner/policies/cadrl/joint_state.h"

namespace roundabout::planner {

namespace {

constexpr double kLongestS = 1.0;
// A slow agent looks farther ahead in time.
constexpr double kShortestWayM = 0.5;
constexpr double kAtGoalM = 0.05;
constexpr double kCollisionReward = -0.25;
constexpr double kLeastValue = -0.25;
constexpr double kMostValue = 1.0;

/// What a reward is worth that is so far away.
double discount(double distance_m) {
  constexpr double kGamma = 0.97;
  constexpr double kGammaDistanceM = 0.5;
  static const double rate = std::log(kGamma) / kGammaDistanceM;
  return std::exp(rate * distance_m);
}

/// Of a way that comes as near as gap_m to others, gap_now_m at its start.
double rewardOf(double gap_now_m, double gap_m, double penalty) {
  if (gap_now_m < 0.0 || gap_m < 0.0) {
    return kCollisionReward;
  }
  const bool close_now = gap_now_m < kCadrlCloseM;
  const bool gets_close = gap_m > 0.0 && gap_m < kCadrlCloseM;
  const double reward = (close_now ? penalty : 0.0) + (gets_close ? penalty : 0.0);
  return gets_close ? std::clamp(2.0 * reward + 5.0 * penalty * (kCadrlCloseM - gap_m),
                                 kCollisionReward + 0.01, 0.0)
                    : reward;
}

core::EgoAgent moved(const core::EgoAgent& ego, const Candidate& candidate, double duration_s) {
  core::EgoAgent there = ego;
  there.position_world_m += duration_s * candidate.velocity_world_mps;
  there.velocity_world_mps = candidate.velocity_world_mps;
  there.heading_world_rad = candidate.heading_world_rad;
  return there;
}

double distanceToGoal(const core::EgoAgent& ego) {
  return (ego.goal_world_m - ego.position_world_m).norm();
}

}  // namespace

LookAhead::LookAhead(std::shared_ptr<const CadrlWeights> weights) : network_(std::move(weights)) {}

LookAhead::Choice LookAhead::choose(const core::EgoAgent& ego,
                                    std::span<const core::OtherAgent> others) {
  const double preferred_mps = ego.preferred_speed_mps;
  duration_s_ = std::min(std::max(kLongestS, kShortestWayM / preferred_mps),
                         distanceToGoal(ego) / preferred_mps);
  candidates_ = candidatesOf(ego);
  judgeWays(ego, others);
  judgeEnds(ego, others);

  Choice best{{}, -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const double time_s = duration_s_ * (0.2 + 0.8 * candidates_[i].speed_mps / preferred_mps);
    const double value =
        outlooks_[i].reward + discount(time_s * preferred_mps) * outlooks_[i].value;
    if (value > best.value) {
      best = {candidates_[i], value};
    }
  }
  return best;
}

/// Rewards; values of those that collide or reach the goal; the others are left to be judged.
void LookAhead::judgeWays(const core::EgoAgent& ego, std::span<const core::OtherAgent> others) {
  double gap_now_m = std::numeric_limits<double>::infinity();
  for (const core::OtherAgent& other : others) {
    gap_now_m = std::min(gap_now_m, (other.position_world_m - ego.position_world_m).norm() -
                                        ego.radius_m - other.radius_m);
  }
  const double penalty =
      discount(distanceToGoal(ego)) * (1.0 - 1.0 / discount(ego.preferred_speed_mps));
  std::size_t judged = 0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    Encounter nearest{std::numeric_limits<double>::infinity(), false};
    for (const core::OtherAgent& other : others) {
      const Encounter encounter = encounterWith(other, ego, candidates_[i], duration_s_);
      nearest.closest_gap_m = std::min(nearest.closest_gap_m, encounter.closest_gap_m);
      nearest.collides = nearest.collides || encounter.collides;
    }
    outlooks_[i] = {rewardOf(gap_now_m, nearest.closest_gap_m, penalty), 0.0};
    if (nearest.collides) {
      continue;
    }
    const double left_m = distanceToGoal(moved(ego, candidates_[i], duration_s_));
    if (left_m < kAtGoalM && nearest.closest_gap_m > kCadrlCloseM) {
      outlooks_[i].value = discount(left_m);
    } else {
      judged_[judged++] = i;
    }
  }
  judged_count_ = judged;
}

/// Values of where the remaining candidates lead.
void LookAhead::judgeEnds(const core::EgoAgent& ego, std::span<const core::OtherAgent> others) {
  if (judged_count_ == 0) {
    return;
  }
  std::array<core::OtherAgent, kCadrlOthers> there;
  const auto end =
      std::transform(others.begin(), others.end(), there.begin(), [this](core::OtherAgent other) {
        other.position_world_m += duration_s_ * other.velocity_world_mps;
        return other;
      });
  // Whoever is closest to the first end comes first, for all ends.
  const Eigen::Vector2d first = moved(ego, candidates_[judged_[0]], duration_s_).position_world_m;
  const auto distance = [&first](const core::OtherAgent& other) {
    return (other.position_world_m - first).norm();
  };
  std::iter_swap(there.begin(),
                 std::min_element(there.begin(), end,
                                  [&](const core::OtherAgent& a, const core::OtherAgent& b) {
                                    return distance(a) < distance(b);
                                  }));
  for (std::size_t k = 0; k < judged_count_; ++k) {
    states_[k] = jointState(moved(ego, candidates_[judged_[k]], duration_s_), {there.begin(), end});
  }
  const std::span<const float> values = network_.evaluate(std::span(states_).first(judged_count_));
  for (std::size_t k = 0; k < judged_count_; ++k) {
    // No value is above that of the straight way.
    const double straight = discount(double{states_[k].own[0]});
    outlooks_[judged_[k]].value =
        std::min(std::clamp(double{values[k]}, kLeastValue, kMostValue), straight);
  }
}

}  // namespace roundabout::planner
