// Tracks against the truth, as a lab would judge them.

#include <numbers>

#include <gtest/gtest.h>

#include "tests/perception/tracking_run.h"

namespace roundabout::perception {
namespace {

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

TEST(Tracking, FollowsSixPeopleWhoAllWalk) {
  test::CrowdSettings settings;
  settings.standing = 0;
  settings.field_of_view_rad = 2.0 * std::numbers::pi * 1079.0 / 1080.0;
  ClearMot all(0.5);
  for (settings.seed = 11; settings.seed <= 13; ++settings.seed) {
    follow(settings, "breakpoints", 60.0, &all);
  }
  say("all walk", all.result());
  EXPECT_GT(all.result().accuracy, 0.9);
  EXPECT_LT(all.result().velocity_rms_mps, 0.15);
}

}  // namespace
}  // namespace roundabout::perception
