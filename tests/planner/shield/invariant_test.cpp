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
  double closest_static_m = 1e9;
};

/// Half of the runs attack, half wish at random. The first seed is never the same for two tests.
Total runMany(const CrowdSettings& settings, ShieldParameters parameters, int runs,
              double duration_s, bool breaker = false) {
  parameters.breaker = breaker;
  Total total;
  for (int k = 0; k < runs; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    Crowd crowd(settings, parameters, seed);
    const bool attacks = k % 2 == 0;
    total.decisions +=
        crowd.run(duration_s, attacks ? Crowd::Want(attack) : Crowd::Want(RandomWishes(seed)));
    total.closest_m = std::min(total.closest_m, crowd.closestGapM());
    total.closest_static_m = std::min(total.closest_static_m, crowd.closestStaticM());
    EXPECT_GT(crowd.closestGapM(), 0.0) << (attacks ? "attack" : "random") << ", seed " << seed;
    EXPECT_GT(crowd.closestStaticM(), 0.0) << (attacks ? "attack" : "random") << ", seed " << seed;
  }
  testing::Test::RecordProperty("decisions", std::to_string(total.decisions));
  testing::Test::RecordProperty("closest_gap_m", std::to_string(total.closest_m));
  testing::Test::RecordProperty("closest_static_m", std::to_string(total.closest_static_m));
  return total;
}

CrowdSettings lab() {
  CrowdSettings settings;
  settings.truth = settings.assumed = multirotor();
  return settings;
}

TEST(ShieldInvariant, HoldsUnderIdealRulesWhateverIsWanted) {
  CrowdSettings settings;
  settings.ideal = true;
  settings.vehicles = 10;
  // The margin, to rounding: what is promised.
  EXPECT_GT(runMany(settings, ShieldParameters::idealRules(), 20 * kRuns, 30.0).closest_m, 0.00499);
}

TEST(ShieldInvariant, HoldsUnderIdealRulesWhileTheBreakerFlies) {
  CrowdSettings settings;
  settings.ideal = true;
  settings.vehicles = 10;
  EXPECT_GT(runMany(settings, ShieldParameters::idealRules(), 10 * kRuns, 30.0, true).closest_m,
            0.00499);
}

TEST(ShieldInvariant, HoldsInTheLabWhateverIsWanted) {
  runMany(lab(), ShieldParameters::lab(), 20 * kRuns, 30.0);
}

TEST(ShieldInvariant, HoldsInTheLabWhileTheBreakerFlies) {
  runMany(lab(), ShieldParameters::lab(), 6 * kRuns, 30.0, true);
}

TEST(ShieldInvariant, HoldsWhereAFifthOfAllMessagesIsLost) {
  CrowdSettings settings = lab();
  settings.loss = 0.2;
  runMany(settings, ShieldParameters::lab(), 10 * kRuns, 30.0);
}

TEST(ShieldInvariant, HoldsWhereLagAndDelayAreHalfAsMuchAgain) {
  CrowdSettings settings = lab();
  settings.assumed.reserve = 1.5;
  settings.truth = settings.assumed.at(Pace::kSlowest);
  runMany(settings, ShieldParameters::lab(), 10 * kRuns, 30.0);
}

TEST(ShieldInvariant, HoldsAtWallsAndObstacles) {
  CrowdSettings settings = lab();
  settings.room_half_side_m = 4.0;
  settings.half_side_m = 3.3;
  settings.obstacles = {{{-1.0, -1.0}, {1.0, -1.0}, {0.5, 1.0}}};
  runMany(settings, ShieldParameters::lab(), 6 * kRuns, 30.0);
}

TEST(ShieldInvariant, HoldsForRobotsThatTurnSlowly) {
  CrowdSettings settings = lab();
  settings.truth.delay_s = 0.05;
  settings.truth.lag_s = 0.1;
  settings.truth.inner_lag_s = 0.0;
  settings.truth.max_turn_rate_radps = 1.5;
  settings.assumed = settings.truth;
  settings.room_half_side_m = 4.0;
  settings.half_side_m = 3.3;
  runMany(settings, ShieldParameters::lab(), 10 * kRuns, 30.0);
}

}  // namespace
}  // namespace roundabout::planner::shield
