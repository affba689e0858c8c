// Tracks against the truth, as a lab would judge them.

#include <cstdio>

#include <gtest/gtest.h>

#include "perception/agent_finder.h"
#include "perception/clustering/table.h"
#include "tests/perception/crowd.h"

namespace roundabout::perception {
namespace {

ClearMot::Result follow(const test::CrowdSettings& settings, const std::string& clusterer,
                        double duration_s = 30.0, ClearMot* together = nullptr) {
  test::Crowd crowd(settings);
  config::Perception perception;
  perception.max_range_m = settings.range_m;
  AgentFinder finder(perception, makeClusterer(clusterer, "test"));
  ClearMot judge(0.5);
  constexpr double kPeriod_s = 0.025;
  for (double time_s = 0.0; time_s < duration_s; time_s += kPeriod_s) {
    crowd.step(kPeriod_s);
    finder.update(crowd.scan(), crowd.robot(), crowd.robot(), nullptr);
    std::vector<Sighting> tracked;
    for (const core::AgentTrack& track : finder.tracker().tracks()) {
      if (crowd.isJudged(track.position_world_m)) {
        tracked.push_back({track.id, track.position_world_m, track.velocity_world_mps});
      }
    }
    if (time_s > 1.0) {
      judge.add(crowd.visible(), tracked);
      if (together != nullptr) {
        // Other people in every crowd.
        std::vector<Sighting> people = crowd.visible();
        for (Sighting& somebody : people) {
          somebody.id += 1000 * static_cast<std::int32_t>(settings.seed);
        }
        together->add(people, tracked);
      }
    }
  }
  return judge.result();
}

void say(const char* what, const ClearMot::Result& result) {
  std::printf(
      "%-34s MOTA %.3f MOTP %.3f m, switches %lld, missed %.3f, false %.3f, velocity %.3f m/s\n",
      what, result.accuracy, result.precision_m, static_cast<long long>(result.switches),
      static_cast<double>(result.misses) / static_cast<double>(result.truths),
      static_cast<double>(result.false_tracks) / static_cast<double>(result.truths),
      result.velocity_rms_mps);
}

class Clusterers : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Table, Clusterers, ::testing::Values("breakpoints", "dynamic_means"),
                         [](const auto& entry) { return std::string(entry.param); });

TEST_P(Clusterers, FollowSixPeopleWithinSixMetres) {
  test::CrowdSettings settings;
  settings.field_of_view_rad = 2.0 * std::numbers::pi * 1079.0 / 1080.0;
  for (settings.seed = 1; settings.seed <= 3; ++settings.seed) {
    const ClearMot::Result result = follow(settings, GetParam());
    say(GetParam(), result);
    EXPECT_GT(result.accuracy, 0.9);
    EXPECT_LT(result.velocity_rms_mps, 0.15);
  }
}

/// The table of docs/perception.md; prints it with --gtest_also_run_disabled_tests.
TEST(TrackingQuality, DISABLED_Table) {
  const auto row = [](const std::string& what, test::CrowdSettings settings) {
    for (const char* clusterer : {"breakpoints", "dynamic_means"}) {
      settings.field_of_view_rad = 2.0 * std::numbers::pi * (settings.beams - 1) / settings.beams;
      ClearMot all(0.5);
      for (settings.seed = 11; settings.seed <= 13; ++settings.seed) {
        follow(settings, clusterer, 60.0, &all);
      }
      say((what + " " + clusterer).c_str(), all.result());
    }
  };
  row("six people, half of them standing", {});
  row("all walk", {.standing = 0});
  row("robot at 1.2 m/s", {.robot_speed_mps = 1.2});
  row("12 people", {.people = 12, .standing = 4});
  row("18 people, 0.5 m apart", {.people = 18, .standing = 6, .closest_m = 0.5});
  row("within 4 m", {.reach_m = 4.0});
  row("within 8 m", {.reach_m = 8.0, .range_m = 14.0});
  row("5 % missed returns", {.missed_share = 0.05});
  row("20 % missed returns", {.missed_share = 0.2});
  row("40 % missed returns", {.missed_share = 0.4});
  row("range noise 4 cm", {.noise_m = 0.04});
  row("512 beams", {.beams = 512});
  row("360 beams", {.beams = 360});
}

}  // namespace
}  // namespace roundabout::perception
