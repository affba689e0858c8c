#include "common/core/frame_gate.h"

#include <limits>

#include <gtest/gtest.h>

namespace roundabout::core {
namespace {

constexpr Utime kFrame = 5'000;
constexpr FrameVerdict kRefused = FrameVerdict::kRefused;
constexpr FrameVerdict kAccepted = FrameVerdict::kAccepted;

// Sends frames until one is not refused; returns how many were.
int refusedBefore(FrameGate& gate, Utime first, FrameVerdict expected) {
  for (int refused = 0; refused < 100; ++refused) {
    const FrameVerdict verdict = gate.judge(first + refused * kFrame);
    if (verdict != kRefused) {
      EXPECT_EQ(verdict, expected);
      return refused;
    }
  }
  return -1;
}

TEST(FrameGate, RefusesStampsThatAreNotNewer) {
  FrameGate gate;
  EXPECT_EQ(gate.judge(1'000'000), kAccepted);
  EXPECT_EQ(gate.judge(1'000'000), kRefused);
  EXPECT_EQ(gate.judge(999'999), kRefused);
  EXPECT_EQ(gate.judge(1'000'001), kAccepted);
}

TEST(FrameGate, OneCorruptStampChangesNothing) {
  for (const Utime corrupt :
       {Utime{0}, Utime{-1}, Utime{1}, Utime{1'300'000}, Utime{4'000'000'000'000},
        std::numeric_limits<Utime>::max(), std::numeric_limits<Utime>::min()}) {
    FrameGate gate;
    EXPECT_EQ(gate.judge(1'000'000), kAccepted);
    EXPECT_EQ(gate.judge(corrupt), kRefused) << corrupt;
    EXPECT_EQ(gate.judge(1'005'000), kAccepted) << corrupt;
  }
}

TEST(FrameGate, AcceptsASourceThatComesBackMuchLater) {
  FrameGate gate;
  gate.judge(1'000'000);
  EXPECT_EQ(refusedBefore(gate, 100'000'000, kAccepted), 9);
}

TEST(FrameGate, ASourceThatWasStartedAnewBeginsANewEpoch) {
  FrameGate gate;
  gate.judge(100'000'000);
  EXPECT_EQ(refusedBefore(gate, 1'000'000, FrameVerdict::kNewEpoch), 9);
}

TEST(FrameGate, ACorruptFirstStampDoesNotBlindIt) {
  FrameGate gate;
  gate.judge(std::numeric_limits<Utime>::max());
  EXPECT_EQ(refusedBefore(gate, 1'000'000, FrameVerdict::kNewEpoch), 9);
}

TEST(FrameGate, AClockSetBackALittleIsWaitedFor) {
  FrameGate gate;
  gate.judge(1'000'000);
  EXPECT_EQ(refusedBefore(gate, 900'000, kAccepted), 21);
}

TEST(FrameGate, AnOldFlightPlayedIntoThisOneIsNeverBelieved) {
  FrameGate gate;
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_EQ(gate.judge(500'000'000 + i * kFrame), kAccepted);
    EXPECT_EQ(gate.judge(1'000'000 + i * kFrame), kRefused);
  }
}

}  // namespace
}  // namespace roundabout::core
