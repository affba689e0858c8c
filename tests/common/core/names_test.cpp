#include <gtest/gtest.h>

#include "common/core/command.h"
#include "common/core/fleet_phase.h"
#include "common/core/planner_mode.h"

namespace roundabout::core {
namespace {

TEST(Names, AreTheWordsOfTheMessages) {
  EXPECT_STREQ(nameOf(FleetPhase::kTakeOff), "take_off");
  EXPECT_STREQ(nameOf(PlannerMode::kAtGoal), "at_goal");
  EXPECT_STREQ(nameOf(SafetyOrderKind::kResume), "resume");
}

TEST(Names, OfNumbersThatAMessageMayHoldButNobodyKnowsAreUnknown) {
  EXPECT_STREQ(nameOf(static_cast<FleetPhase>(-3)), "unknown");
  EXPECT_STREQ(nameOf(static_cast<PlannerMode>(99)), "unknown");
  EXPECT_STREQ(nameOf(static_cast<SafetyOrderKind>(7)), "unknown");
}

}  // namespace
}  // namespace roundabout::core
