// What every entry of the table of policies promises (planner/policy.h).

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "common/core/angles.h"
#include "planner/policies/table.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/allocation_count.h"
#include "tests/support/cadrl_weights.h"
#include "tests/support/drl_maca_weights.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMostOthers = 40;

// A decision that outlives the next query.
struct Answer {
  explicit Answer(const Decision& decision)
      : speed_mps(decision.speed_mps),
        heading_change_rad(decision.heading_change_rad),
        action(decision.action),
        probabilities(decision.action_probabilities.begin(), decision.action_probabilities.end()) {}

  bool operator==(const Answer&) const = default;

  double speed_mps;
  double heading_change_rad;
  int action;
  std::vector<float> probabilities;
};

// The table's ga3c_cadrl again, with networks of other architectures.
constexpr std::array kOtherArchitectures = {kWeightSharingArchitecture, kPooledArchitecture,
                                            kAttentionArchitecture};

bool isArchitecture(std::string_view name) {
  return std::ranges::find(kOtherArchitectures, name) != kOtherArchitectures.end();
}

class PolicyContract : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Policy> make() { return makePolicy(specification_, {}); }

  void SetUp() override {
    specification_ = tableName();
    if (isArchitecture(GetParam())) {
      const std::string weights = folder_ / "weights.safetensors";
      nn::writeSafetensors(weights, test::randomGa3cCadrl(1, GetParam(), 5));
      specification_ += ":" + weights;
    } else if (GetParam() == "ga3c_cadrl") {
      const std::string weights = folder_ / "weights.safetensors";
      test::writeRandomGa3cCadrl(weights);
      specification_ += ":" + weights;
    } else if (GetParam() == "cadrl") {
      const std::string weights = folder_ / "weights.safetensors";
      nn::writeSafetensors(weights, test::randomCadrl());
      specification_ += ":" + weights;
    } else if (GetParam() == "drl_maca") {
      const std::string weights = folder_ / "weights.safetensors";
      nn::writeSafetensors(weights, test::randomDrlMaca());
      specification_ += ":" + weights;
    }
    core::RandomStream random(1, "scan");
    for (float& range_m : ranges_m_) {
      range_m = static_cast<float>(random.uniform(0.0, 6.0));
    }
  }

  static std::string tableName() { return isArchitecture(GetParam()) ? "ga3c_cadrl" : GetParam(); }

  // With a scan for policies that need one; it has nothing to do with the scene.
  core::Surroundings around(const Scene& scene) const {
    core::Surroundings result(scene.others);
    result.scan = {-std::numbers::pi / 2.0,
                   std::numbers::pi / static_cast<double>(ranges_m_.size() - 1), 6.0, ranges_m_};
    return result;
  }

  // Every number of others, from all over the room to all on top of each other.
  template <class Check>
  void forManyScenes(Check check) {
    core::RandomStream random(1, "scenes");
    for (std::size_t num_others = 0; num_others <= kMostOthers; ++num_others) {
      for (const double half_side_m : {0.5, 2.0, 6.0, 20.0}) {
        SCOPED_TRACE(::testing::Message()
                     << num_others << " others in " << 2.0 * half_side_m << " m");
        check(randomScene(random, num_others, half_side_m), random);
      }
    }
  }

 private:
  test::ScratchFolder folder_;
  std::string specification_;
  std::vector<float> ranges_m_ = std::vector<float>(512);
};

void expectSound(const Scene& scene, const Decision& decision) {
  EXPECT_GE(decision.speed_mps, 0.0);
  EXPECT_LE(decision.speed_mps, scene.ego.preferred_speed_mps);
  EXPECT_GE(decision.heading_change_rad, -std::numbers::pi);
  EXPECT_LE(decision.heading_change_rad, std::numbers::pi);
  EXPECT_GE(decision.neighbours_used, 0);
  EXPECT_LE(decision.neighbours_used, static_cast<int>(scene.others.size()));

  const auto probabilities = decision.action_probabilities;
  if (probabilities.empty()) {
    EXPECT_EQ(decision.action, -1);
    return;
  }
  EXPECT_NEAR(std::accumulate(probabilities.begin(), probabilities.end(), 0.0), 1.0, 1e-5);
  EXPECT_GE(*std::min_element(probabilities.begin(), probabilities.end()), 0.0F);
  EXPECT_EQ(decision.action,
            std::max_element(probabilities.begin(), probabilities.end()) - probabilities.begin());
  ASSERT_EQ(decision.actions.size(), probabilities.size());
  const DiscreteAction& chosen = decision.actions[static_cast<std::size_t>(decision.action)];
  EXPECT_EQ(decision.speed_mps, chosen.speed_fraction * scene.ego.preferred_speed_mps);
  EXPECT_EQ(decision.heading_change_rad, chosen.heading_change_rad);
}

TEST_P(PolicyContract, NameIsTheTables) { EXPECT_EQ(make()->name(), tableName()); }

TEST_P(PolicyContract, DecisionsAreSound) {
  const auto policy = make();
  forManyScenes([&](const Scene& scene, core::RandomStream&) {
    expectSound(scene, policy->decide(scene.ego, around(scene)));
  });
}

TEST_P(PolicyContract, DegenerateScenesAreAnsweredSoundly) {
  const auto policy = make();
  const auto check = [&](const Scene& scene, const char* what) {
    SCOPED_TRACE(what);
    expectSound(scene, policy->decide(scene.ego, around(scene)));
  };
  forManyScenes([&](const Scene& scene, core::RandomStream&) {
    Scene changed = scene;
    changed.ego.goal_world_m = scene.ego.position_world_m;
    check(changed, "on its goal");

    changed = scene;
    changed.ego.velocity_world_mps.setZero();
    for (core::OtherAgent& other : changed.others) {
      other.velocity_world_mps.setZero();
    }
    check(changed, "all stand");

    changed = scene;
    for (core::OtherAgent& other : changed.others) {
      other.position_world_m = scene.ego.position_world_m;
    }
    check(changed, "all in one place");

    for (core::OtherAgent& other : changed.others) {
      other.velocity_world_mps = scene.ego.velocity_world_mps;
    }
    check(changed, "all in one place at one velocity");

    changed = scene;
    changed.ego.goal_world_m *= 1e6;
    for (core::OtherAgent& other : changed.others) {
      other.position_world_m *= 1e6;
    }
    check(changed, "far away");

    changed = scene;
    for (core::OtherAgent& other : changed.others) {
      other = changed.others.front();
    }
    check(changed, "all others the same");
  });
}

TEST_P(PolicyContract, ATwinAnswersAsOneThatWasJustMade) {
  const auto used = make();
  const auto unused = make();
  forManyScenes([&](const Scene& scene, core::RandomStream&) {
    used->decide(scene.ego, around(scene));
    const auto twin = used->twin();
    EXPECT_EQ(twin->name(), used->name());
    EXPECT_EQ(Answer(twin->decide(scene.ego, around(scene))),
              Answer(unused->twin()->decide(scene.ego, around(scene))));
  });
}

TEST_P(PolicyContract, HeadOnIsAnsweredSoundly) {
  const auto policy = make();
  for (double distance_m = 0.0; distance_m <= 10.0; distance_m += 0.125) {
    for (const double closing_mps : {0.0, 0.5, 1.0}) {
      Scene scene;
      scene.ego.goal_world_m = {10.0, 0.0};
      scene.ego.velocity_world_mps = {closing_mps, 0.0};
      scene.others = {{{distance_m, 0.0}, {-closing_mps, 0.0}, 0.5}};
      SCOPED_TRACE(distance_m);
      expectSound(scene, policy->decide(scene.ego, around(scene)));
    }
  }
}

TEST_P(PolicyContract, SameSceneSameDecision) {
  const auto policy = make();
  const auto twin = make();
  forManyScenes([&](const Scene& scene, core::RandomStream&) {
    policy->reset();
    twin->reset();
    const Answer first(policy->decide(scene.ego, around(scene)));
    EXPECT_EQ(Answer(twin->decide(scene.ego, around(scene))), first);
    policy->reset();
    EXPECT_EQ(Answer(policy->decide(scene.ego, around(scene))), first);
  });
}

TEST_P(PolicyContract, OrderOfOthersDoesNotMatter) {
  const auto policy = make();
  forManyScenes([&](Scene scene, core::RandomStream& random) {
    policy->reset();
    const Answer before(policy->decide(scene.ego, around(scene)));
    random.shuffle(scene.others);
    policy->reset();
    EXPECT_EQ(Answer(policy->decide(scene.ego, around(scene))), before);
  });
}

// The scene as somebody sees it whose world frame lies elsewhere.
Scene moved(const Scene& scene, double angle_rad, const Vector2d& shift_m) {
  const Eigen::Rotation2Dd turn(angle_rad);
  Scene result = scene;
  result.ego.position_world_m = turn * scene.ego.position_world_m + shift_m;
  result.ego.velocity_world_mps = turn * scene.ego.velocity_world_mps;
  result.ego.heading_world_rad = core::wrapToPi(scene.ego.heading_world_rad + angle_rad);
  result.ego.goal_world_m = turn * scene.ego.goal_world_m + shift_m;
  for (core::OtherAgent& other : result.others) {
    other.position_world_m = turn * other.position_world_m + shift_m;
    other.velocity_world_mps = turn * other.velocity_world_mps;
  }
  return result;
}

TEST_P(PolicyContract, WorldFrameDoesNotMatter) {
  if (GetParam() == "cadrl") {
    GTEST_SKIP() << "the published code uses the world's x axis; see docs/policies.md";
  }
  const auto policy = make();
  forManyScenes([&](const Scene& scene, core::RandomStream& random) {
    policy->reset();
    const Answer here(policy->decide(scene.ego, around(scene)));
    const double angle_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
    const Scene elsewhere = moved(scene, angle_rad, randomVector(random, 20.0));
    policy->reset();
    const Answer there(policy->decide(elsewhere.ego, around(elsewhere)));

    if (!here.probabilities.empty()) {
      // Single precision may decide between two actions that are equally probable.
      for (std::size_t i = 0; i < here.probabilities.size(); ++i) {
        EXPECT_NEAR(there.probabilities[i], here.probabilities[i], 1e-4);
      }
      return;
    }
    EXPECT_NEAR(there.speed_mps, here.speed_mps, 1e-6);
    EXPECT_NEAR(core::wrapToPi(there.heading_change_rad - here.heading_change_rad), 0.0, 1e-6);
  });
}

TEST_P(PolicyContract, AllocatesNothingAfterTheFirstCallWithAsManyOthers) {
  const auto policy = make();
  core::RandomStream random(2, "allocations");
  for (std::size_t num_others = 0; num_others <= kMostOthers; ++num_others) {
    const Scene easy = randomScene(random, num_others, 100.0);
    const Scene crowded = randomScene(random, num_others, 1.0);
    policy->decide(easy.ego, around(easy));
    const std::size_t before = test::allocationCount();
    policy->decide(crowded.ego, around(crowded));
    policy->decide(easy.ego, around(easy));
    const std::size_t after = test::allocationCount();
    EXPECT_EQ(after, before) << num_others << " others";
  }
}

core::Polygon randomTriangle(core::RandomStream& random, double half_side_m) {
  const Vector2d corner = randomVector(random, half_side_m);
  return {corner, corner + Vector2d(random.uniform(0.1, 5.0), 0.0),
          corner + Vector2d(0.0, random.uniform(0.1, 5.0))};
}

TEST_P(PolicyContract, ObstaclesAreAnsweredSoundlyWithoutAllocation) {
  const auto policy = make();
  core::RandomStream random(3, "obstacles");
  for (std::size_t num_others = 0; num_others <= 10; ++num_others) {
    const Scene far = randomScene(random, num_others, 1000.0);
    const Scene near = randomScene(random, num_others, 2.0);
    std::vector<core::Polygon> obstacles;
    for (std::size_t i = 0; i <= num_others; ++i) {
      obstacles.push_back(randomTriangle(random, 4.0));
    }
    const auto decide = [&](const Scene& scene) {
      core::Surroundings around(scene.others);
      around.obstacles = obstacles;
      return policy->decide(scene.ego, around);
    };
    expectSound(far, decide(far));
    const std::size_t before = test::allocationCount();
    const Decision decision = decide(near);
    EXPECT_EQ(test::allocationCount(), before) << num_others << " others";
    expectSound(near, decision);
  }
}

std::vector<std::string> policyNames() {
  std::vector<std::string> names;
  for (const PolicyEntry& entry : policyTable()) {
    names.emplace_back(entry.name);
  }
  names.insert(names.end(), kOtherArchitectures.begin(), kOtherArchitectures.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Table, PolicyContract, ::testing::ValuesIn(policyNames()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace roundabout::planner
