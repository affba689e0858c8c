#include "common/core/frame_gate.h"

#include <gtest/gtest.h>

namespace roundabout::core {
namespace {

TEST(FrameGate, RefusesStampsThatAreNotNewer) {
  FrameGate gate;
  EXPECT_TRUE(gate.accept(1'000'000));
  EXPECT_FALSE(gate.accept(1'000'000));
  EXPECT_FALSE(gate.accept(999'999));
  EXPECT_TRUE(gate.accept(1'000'001));
}

TEST(FrameGate, OneCorruptStampChangesNothing) {
  FrameGate gate;
  EXPECT_TRUE(gate.accept(1'000'000));
  EXPECT_FALSE(gate.accept(4'000'000'000'000));
  EXPECT_TRUE(gate.accept(1'005'000));
}

TEST(FrameGate, AcceptsASourceThatComesBackMuchLater) {
  FrameGate gate;
  EXPECT_TRUE(gate.accept(1'000'000));
  int refused = 0;
  core::Utime utime = 100'000'000;
  while (!gate.accept(utime) && refused < 100) {
    utime += 5'000;
    ++refused;
  }
  EXPECT_EQ(refused, 9);
}

}  // namespace
}  // namespace roundabout::core
