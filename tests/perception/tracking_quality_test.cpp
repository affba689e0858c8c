// Tracks against the truth, as a lab would judge them.

#include <cstdio>

#include <gtest/gtest.h>

#include "perception/agent_finder.h"
#include "perception/clustering/table.h"
#include "tests/perception/crowd.h"

namespace roundabout::perception {
namespace {

ClearMot::Result follow(const test::CrowdSettings& settings, const std::string& clusterer,
                        double duration_s = 60.0) {
  test::Crowd crowd(settings);
  AgentFinder finder({}, makeClusterer(clusterer, "test"));
  ClearMot judge;
  constexpr double kPeriod_s = 0.025;
  for (double time_s = 0.0; time_s < duration_s; time_s += kPeriod_s) {
    crowd.step(kPeriod_s);
    finder.update(crowd.scan(), crowd.robot(), crowd.robot(), nullptr);
    std::vector<Sighting> tracked;
    for (const core::AgentTrack& track : finder.tracker().tracks()) {
      tracked.push_back({track.id, track.position_world_m, track.velocity_world_mps});
    }
    if (time_s > 1.0) {
      judge.add(crowd.visible(), tracked);
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

}  // namespace
}  // namespace roundabout::perception
