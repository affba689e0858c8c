// Whatever policies want, shielded vehicles do not touch.

#include <gtest/gtest.h>

#include "tests/planner/shield/crowd.h"

namespace roundabout::planner::shield {
namespace {

using Eigen::Vector2d;

#ifndef ROUNDABOUT_SHIELD_RUNS
#define ROUNDABOUT_SHIELD_RUNS 1
#endif
constexpr int kRuns = ROUNDABOUT_SHIELD_RUNS;

MotionBounds multirotor() {
  MotionBounds bounds;
  bounds.delay_s = 0.08;
  bounds.lag_s = 1.0 / 3.0;
  bounds.inner_lag_s = 0.15;
  bounds.max_acceleration_mps2 = 3.0;
  return bounds;
}

/// Any velocity up to the top speed, another one now and then.
class RandomWishes {
 public:
  explicit RandomWishes(std::uint64_t seed) : random_(seed, "wishes") {}

  Vector2d operator()(const Crowd& crowd, std::size_t i) {
    wishes_.resize(crowd.vehicles().size(), Vector2d::Zero());
    if (random_.chance(0.2)) {
      const double angle = random_.uniform(-3.2, 3.2);
      wishes_[i] = crowd.vehicles()[i].top_speed_mps * random_.uniform(0.0, 1.0) *
                   Vector2d(std::cos(angle), std::sin(angle));
    }
    return wishes_[i];
  }

 private:
  core::RandomStream random_;
  std::vector<Vector2d> wishes_;
};

struct Total {
  long decisions = 0;
  double closest_m = 1e9;
};

Total runMany(const CrowdSettings& settings, ShieldParameters parameters, int runs,
              double duration_s) {
  parameters.breaker = false;
  Total total;
  for (int k = 0; k < runs; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    Crowd crowd(settings, parameters, seed);
    const bool attacks = k % 2 == 0;
    total.decisions +=
        crowd.run(duration_s, attacks ? Crowd::Want(attack) : Crowd::Want(RandomWishes(seed)));
    total.closest_m = std::min(total.closest_m, crowd.closestGapM());
    EXPECT_GT(crowd.closestGapM(), 0.0) << (attacks ? "attack" : "random") << ", seed " << seed;
  }
  return total;
}

TEST(ShieldInvariant, HoldsUnderIdealRulesWhateverIsWanted) {
  CrowdSettings settings;
  settings.ideal = true;
  settings.vehicles = 10;
  const Total total = runMany(settings, ShieldParameters::idealRules(), 20 * kRuns, 30.0);
  RecordProperty("decisions", std::to_string(total.decisions));
  RecordProperty("closest_gap_m", std::to_string(total.closest_m));
  EXPECT_GT(total.closest_m, 0.0049);
}

TEST(ShieldInvariant, HoldsInTheLabWhateverIsWanted) {
  CrowdSettings settings;
  settings.truth = settings.assumed = multirotor();
  settings.vehicles = 6;
  const Total total = runMany(settings, ShieldParameters::lab(), 20 * kRuns, 30.0);
  RecordProperty("decisions", std::to_string(total.decisions));
  RecordProperty("closest_gap_m", std::to_string(total.closest_m));
}

}  // namespace
}  // namespace roundabout::planner::shield
