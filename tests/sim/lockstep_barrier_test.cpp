#include "sim/lockstep_barrier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace roundabout::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kFirst = 0;
constexpr std::size_t kSecond = 1;
constexpr std::size_t kFleet = 2;
constexpr core::Utime kBoth = 1'000'000;      // a tick of planners and fleet
constexpr core::Utime kPlanners = 1'100'000;  // of planners only
constexpr core::Utime kNobody = 1'005'000;

class LockstepBarrierTest : public testing::Test {
 protected:
  LockstepBarrier barrier_{2, 10.0, 5.0};

  void everybodyIsThere() {
    for (const std::size_t participant : {kFirst, kSecond, kFleet}) {
      barrier_.heard(participant);
    }
  }
  void everybodyAnswers(core::Utime utime) {
    for (const std::size_t participant : {kFirst, kSecond, kFleet}) {
      barrier_.answered(participant, utime);
    }
  }
};

TEST_F(LockstepBarrierTest, BeginsWithEverybodyAbsent) {
  EXPECT_THAT(barrier_.absent(), ElementsAre(kFirst, kSecond, kFleet));
}

TEST_F(LockstepBarrierTest, WhoIsHeardIsPresent) {
  barrier_.heard(kSecond);
  EXPECT_THAT(barrier_.absent(), ElementsAre(kFirst, kFleet));
}

TEST_F(LockstepBarrierTest, AwaitsNobodyWhoIsAbsent) {
  barrier_.onFrame(kBoth);
  EXPECT_TRUE(barrier_.complete());
}

TEST_F(LockstepBarrierTest, AwaitsEverybodyOnATickOfBoth) {
  everybodyIsThere();
  barrier_.onFrame(kBoth);
  EXPECT_FALSE(barrier_.complete());
  EXPECT_THAT(barrier_.awaited(), ElementsAre(kFirst, kSecond, kFleet));
}

TEST_F(LockstepBarrierTest, AwaitsPlannersOnlyOnATickOfTheirs) {
  everybodyIsThere();
  barrier_.onFrame(kBoth);
  everybodyAnswers(kBoth);
  barrier_.onFrame(kPlanners);
  EXPECT_THAT(barrier_.awaited(), ElementsAre(kFirst, kSecond));
}

TEST_F(LockstepBarrierTest, AwaitsNobodyBetweenTicks) {
  everybodyIsThere();
  barrier_.onFrame(kBoth);
  everybodyAnswers(kBoth);
  barrier_.onFrame(kNobody);
  EXPECT_TRUE(barrier_.complete());
}

TEST_F(LockstepBarrierTest, IsCompleteWhenTheLastHasAnswered) {
  everybodyIsThere();
  barrier_.onFrame(kPlanners);
  barrier_.answered(kFleet, kPlanners);
  barrier_.answered(kSecond, kPlanners);
  EXPECT_FALSE(barrier_.complete());
  barrier_.answered(kFirst, kPlanners);
  EXPECT_TRUE(barrier_.complete());
}

TEST_F(LockstepBarrierTest, AnAnswerToAnotherFrameDoesNotCount) {
  everybodyIsThere();
  barrier_.onFrame(kPlanners);
  barrier_.answered(kFirst, kBoth);
  EXPECT_THAT(barrier_.awaited(), ElementsAre(kFirst, kSecond, kFleet));
}

TEST_F(LockstepBarrierTest, ASignOfLifeIsNotAnAnswer) {
  everybodyIsThere();
  barrier_.onFrame(kPlanners);
  barrier_.heard(kFirst);
  EXPECT_THAT(barrier_.awaited(), testing::Contains(kFirst));
}

TEST_F(LockstepBarrierTest, GivingUpMakesTheAwaitedAbsent) {
  everybodyIsThere();
  barrier_.onFrame(kBoth);
  barrier_.answered(kFirst, kBoth);
  barrier_.giveUp();
  EXPECT_TRUE(barrier_.complete());
  EXPECT_THAT(barrier_.absent(), ElementsAre(kSecond, kFleet));
  barrier_.onFrame(kPlanners);
  EXPECT_THAT(barrier_.awaited(), ElementsAre(kFirst));
}

TEST_F(LockstepBarrierTest, WhoIsHeardAgainIsAwaitedFromTheNextFrameOn) {
  everybodyIsThere();
  barrier_.onFrame(kBoth);
  barrier_.giveUp();
  barrier_.heard(kSecond);
  EXPECT_TRUE(barrier_.complete());
  barrier_.onFrame(kPlanners);
  EXPECT_THAT(barrier_.awaited(), ElementsAre(kSecond));
}

TEST_F(LockstepBarrierTest, ALateAnswerIsASignOfLife) {
  everybodyIsThere();
  barrier_.onFrame(kBoth);
  barrier_.giveUp();
  barrier_.answered(kFirst, kBoth);
  EXPECT_THAT(barrier_.absent(), ElementsAre(kSecond, kFleet));
}

}  // namespace
}  // namespace roundabout::sim
