#include <gmock/gmock.h>

#include "cli/doctor/examination.h"
#include "tests/support/lcm_url.h"

namespace roundabout::cli {
namespace {

using testing::HasSubstr;

TEST(Doctor, SaysHowToGetAMulticastRoute) {
  const Finding finding = judgeRoute("", false, 0, "Network is unreachable");
  EXPECT_EQ(finding.health, Health::kWrong);
  EXPECT_THAT(finding.found, HasSubstr("Network is unreachable"));
  EXPECT_THAT(finding.mend, HasSubstr("ip route add 224.0.0.0/4"));
}

TEST(Doctor, KnowsThatLoopbackReachesNoOtherMachine) {
  EXPECT_EQ(judgeRoute("lo", true, 0, "").health, Health::kWell);
  EXPECT_EQ(judgeRoute("lo", true, 1, "").health, Health::kWrong);
  EXPECT_EQ(judgeRoute("eth0", false, 1, "").health, Health::kWell);
}

TEST(Doctor, SaysHowToGetLargerBuffers) {
  EXPECT_EQ(judgeReceiveBuffer(4 << 20).health, Health::kWell);
  const Finding finding = judgeReceiveBuffer(212992);
  EXPECT_EQ(finding.health, Health::kWorthKnowing);
  EXPECT_THAT(finding.found, HasSubstr("208 kB"));
  EXPECT_EQ(finding.mend, "sudo sysctl -w net.core.rmem_max=4194304");
}

TEST(Doctor, NotesAClockThatNobodySets) {
  EXPECT_EQ(judgeClock(true, 0.01).health, Health::kWell);
  EXPECT_THAT(judgeClock(false, 16.0).mend, HasSubstr("chrony"));
}

TEST(Doctor, HearsItselfOnThisMachine) {
  for (const Finding& finding : examine(test::ownLcmUrl())) {
    if (finding.what == "own message" || finding.what == "multicast route") {
      EXPECT_EQ(finding.health, Health::kWell) << finding.found;
    }
  }
}

}  // namespace
}  // namespace roundabout::cli
