#include "planner/policies/ga3c_cadrl/stall_breaker.h"

#include <array>
#include <bit>
#include <cmath>

#include "planner/policies/ga3c_cadrl/actions.h"

namespace roundabout::planner {

namespace {

// A way that is this much longer from one decision to the next is another one.
constexpr double kAnotherWay_m = 0.5;

/// The next number of a sequence (SplitMix64, Steele et al. 2014).
std::uint64_t next(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15ULL;
  std::uint64_t mixed = state;
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9ULL;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebULL;
  return mixed ^ (mixed >> 31);
}

/// Differs between agents of the same flight: those that mirror each other must not act alike.
std::uint64_t seedOf(const core::EgoAgent& ego) {
  std::uint64_t seed = 0;
  for (const double number : {ego.position_world_m.x(), ego.position_world_m.y(),
                              ego.goal_world_m.x(), ego.goal_world_m.y()}) {
    seed ^= std::bit_cast<std::uint64_t>(number);
    seed = next(seed);
  }
  return seed;
}

bool standsStill(const DiscreteAction& action) {
  return action.speed_fraction == 0.0 && action.heading_change_rad == 0.0;
}

}  // namespace

int StallBreaker::choose(const core::EgoAgent& ego, std::span<const float> probabilities,
                         int best_action) {
  const double distance_m = std::isnan(ego.way_left_m)
                                ? (ego.goal_world_m - ego.position_world_m).norm()
                                : ego.way_left_m;
  if (!watch_) {
    watch_.emplace(Watch{ego.goal_world_m, distance_m, distance_m, 0, seedOf(ego)});
    return best_action;
  }
  // Another goal, or a longer way than was known: counts from here. To be sent here and there is no
  // progress.
  const bool elsewhere = std::isnan(ego.way_left_m) && watch_->goal_world_m != ego.goal_world_m;
  if (elsewhere || distance_m > watch_->last_m + kAnotherWay_m) {
    watch_->nearest_m = distance_m;
  }
  watch_->goal_world_m = ego.goal_world_m;
  watch_->last_m = distance_m;
  if (distance_m < watch_->nearest_m - settings_.progress_m) {
    watch_->nearest_m = distance_m;
    watch_->decisions_since = 0;
  } else {
    ++watch_->decisions_since;
  }
  return watch_->decisions_since < settings_.decisions ? best_action : draw(probabilities);
}

int StallBreaker::draw(std::span<const float> probabilities) {
  std::array<double, kActions.size()> weights{};
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = standsStill(kActions[i])
                     ? 0.0
                     : std::pow(static_cast<double>(probabilities[i]), settings_.sharpness);
    sum += weights[i];
  }
  constexpr double kInverse = 1.0 / 9007199254740992.0;  // 2^-53
  double left = sum * static_cast<double>(next(watch_->chance) >> 11) * kInverse;
  int last = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0.0) {
      last = static_cast<int>(i);
      left -= weights[i];
      if (left < 0.0) {
        break;
      }
    }
  }
  return last;
}

}  // namespace roundabout::planner
