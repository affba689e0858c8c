#include "mocap_bridge/sources/clock_map.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "mocap_bridge/sources/exposure_clock.h"
#include "mocap_bridge/sources/frame_sequence.h"

namespace roundabout::mocap_bridge {
namespace {

constexpr core::Utime kEpoch = 1'700'000'000'000'000;

// A clock that shows 5000 s at the local epoch and runs 40 ppm fast.
double remoteAt(core::Utime local) { return 5000.0 + core::toSeconds(local - kEpoch) * 1.00004; }

TEST(ClockMap, EchoesGiveTheOtherClockWithinATenthOfAMillisecond) {
  ClockMap map;
  core::RandomStream random(1, "echo");
  double worst_s = 0.0;
  for (int i = 0; i < 400; ++i) {  // 100 s
    const core::Utime sent = kEpoch + i * 250'000;
    const double there_s = 0.0002 + std::abs(random.normal(0.0005));
    const double back_s = 0.0002 + std::abs(random.normal(0.0005));
    const core::Utime answered = sent + core::toUtime(there_s);
    map.addEcho(remoteAt(answered), sent + core::toUtime((there_s + back_s) / 2), there_s + back_s);
    if (i > 40) {
      worst_s = std::max(worst_s, std::abs(core::toSeconds(map.toLocal(remoteAt(sent)) - sent)));
    }
  }
  EXPECT_LT(worst_s, 0.0002);
  EXPECT_NEAR(map.skew(), -40e-6, 20e-6);
}

TEST(ClockMap, ArrivalsGiveTheShortestDelayAndItsJitterDoesNotShow) {
  ClockMap map;
  core::RandomStream random(1, "arrival");
  core::Utime last = 0;
  for (int i = 0; i < 6000; ++i) {  // 30 s at 200 Hz
    const core::Utime sent = kEpoch + i * 5'000;
    map.addArrival(remoteAt(sent), sent + 300 + core::toUtime(std::abs(random.normal(0.001))));
    if (i > 1000) {
      const core::Utime mapped = map.toLocal(remoteAt(sent));
      EXPECT_NEAR(static_cast<double>(mapped - sent), 300.0, 150.0);
      EXPECT_NEAR(static_cast<double>(mapped - last), 5000.0, 20.0);
      last = mapped;
    } else if (i == 1000) {
      last = map.toLocal(remoteAt(sent));
    }
  }
}

TEST(ClockMap, AClockThatWasSetIsFollowed) {
  ClockMap map;
  for (int i = 0; i < 20; ++i) {
    map.addEcho(100.0 + i, kEpoch + i * core::kMicrosPerSecond, 0.001);
  }
  for (int i = 20; i < 25; ++i) {
    map.addEcho(7.0 + i, kEpoch + i * core::kMicrosPerSecond, 0.001);
  }
  EXPECT_EQ(map.toLocal(32.0), kEpoch + 25 * core::kMicrosPerSecond);
}

TEST(ClockMap, AClockThatWasSetByATenthOfASecondIsFollowedToo) {
  for (const double set_s : {0.1, -0.1}) {
    ClockMap map;
    const auto echo = [&](int i, double remote_s) {
      map.addEcho(remote_s, kEpoch + i * 250'000, 0.001);
    };
    for (int i = 0; i < 80; ++i) {
      echo(i, 100.0 + 0.25 * i);
    }
    for (int i = 80; i < 83; ++i) {
      echo(i, 100.0 + 0.25 * i + set_s);
    }
    ASSERT_TRUE(map.ready());
    EXPECT_NEAR(static_cast<double>(map.toLocal(120.75 + set_s)), kEpoch + 83 * 250'000, 1.0);
  }
}

TEST(ClockMap, AnEchoThatWaitedSetsNoClock) {
  ClockMap map;
  for (int i = 0; i < 80; ++i) {
    map.addEcho(100.0 + 0.25 * i, kEpoch + i * 250'000, 0.001);
  }
  map.addEcho(120.05, kEpoch + 80 * 250'000, 0.1);  // all of the trip was the way there
  EXPECT_TRUE(map.ready());
  EXPECT_NEAR(static_cast<double>(map.toLocal(120.25)), kEpoch + 81 * 250'000, 5000.0);
}

TEST(ExposureClock, RefusesExposuresInTheFuture) {
  ExposureClock clock(0.005);
  for (int i = 0; i < 10; ++i) {
    const double sent_s = 10.0 + 0.005 * i;
    EXPECT_TRUE(clock.exposureOf({sent_s - 0.004, sent_s}, kEpoch + i * 5000));
  }
  EXPECT_FALSE(clock.exposureOf({10.2, 10.05}, kEpoch + 50'000)) << "exposed after it was sent";
  EXPECT_FALSE(clock.exposureOf({2.0, 10.055}, kEpoch + 55'000)) << "eight seconds ago";
}

/// A server whose frames of 200 Hz are exposed 4 ms before they leave and 300 us later are here.
class StalledClock : public testing::Test {
 protected:
  void receive(int frame, core::Utime received) {
    const core::Utime sent = kEpoch + frame * 5000;
    const double sent_s = remoteAt(sent - set_back_);
    if (const auto exposure = clock_.exposureOf({sent_s - 0.004, sent_s}, received)) {
      ++published_;
      worst_us_ = std::max(worst_us_, std::abs(*exposure - (sent - 4000)));
    }
  }
  void live(int first, int count) {
    for (int i = first; i < first + count; ++i) {
      receive(i, kEpoch + i * 5000 + 300 + (jitter_ ? i % 7 * 1000 : 0));
      if (echoes_ && i % 50 == 0) {
        clock_.addEcho(remoteAt(kEpoch + i * 5000), kEpoch + i * 5000, 0.0004);
      }
    }
  }
  // Nothing is read from that frame on for 8 s; the socket keeps the first 218.
  void stall(int first) {
    for (int i = 0; i < 218; ++i) {
      receive(first + i, kEpoch + (first + 1600) * 5000 + 10 * i);
    }
  }

  ExposureClock clock_{0.005};
  bool echoes_ = false;
  bool jitter_ = false;  // most arrive up to 6 ms later
  core::Utime set_back_ = 0;
  int published_ = 0;
  core::Utime worst_us_ = 0;
};

TEST_F(StalledClock, ABacklogIsRefusedAndWhatComesAfterItIsRight) {
  for (const bool echoes : {false, true}) {
    echoes_ = echoes;
    clock_ = ExposureClock(0.005);
    live(0, 4000);
    published_ = 0;
    stall(4000);
    EXPECT_EQ(published_, 0);
    live(5601, 200);
    EXPECT_EQ(published_, 200) << "what was known of the clock is still known";
    EXPECT_LT(worst_us_, 1000);
  }
}

TEST_F(StalledClock, ABacklogAfterARestartTeachesNothing) {
  live(0, 400);
  clock_.reset();
  published_ = 0;
  stall(400);
  EXPECT_EQ(published_, 0);
  live(2001, 400);
  EXPECT_GT(published_, 340);
  EXPECT_LT(worst_us_, 1000);
}

TEST_F(StalledClock, AClockThatWasSetBackIsFollowed) {
  live(0, 4000);
  set_back_ = 100 * core::kMicrosPerSecond;
  live(4000, 400);
  published_ = 0;
  live(4400, 200);
  EXPECT_EQ(published_, 200);
  EXPECT_LT(worst_us_, 5000) << "also of the frames between";
}

TEST_F(StalledClock, AClockThatWasSetForwardIsLearnedAnewFromTheNextThree) {
  jitter_ = true;
  for (const core::Utime forward : {30'000, 200'000}) {
    clock_ = ExposureClock(0.005);
    set_back_ = 0;
    live(0, 4000);
    set_back_ = -forward;
    published_ = 0;
    live(4000, 10);
    EXPECT_EQ(published_, 8) << "two come before it is known: those are refused";
    live(4010, 800);
    EXPECT_EQ(published_, 808);
    worst_us_ = 0;
    live(4810, 400);
    EXPECT_LT(worst_us_, 1500) << forward << ": the jitter of arrivals does not show";
  }
}

TEST_F(StalledClock, OneStampFromTheFutureIsRefusedAndTeachesNothing) {
  live(0, 4000);
  published_ = 0;
  set_back_ = -200'000;
  live(4000, 1);
  EXPECT_EQ(published_, 0);
  set_back_ = 0;
  worst_us_ = 0;
  live(4001, 400);
  EXPECT_EQ(published_, 400);
  EXPECT_LT(worst_us_, 1000);
}

TEST_F(StalledClock, NumbersThatPausedGiveStaleStampsForASecondOnly) {
  for (const core::Utime pause : {30'000, 500'000}) {
    clock_ = ExposureClock(0.005);
    set_back_ = 0;
    live(0, 4000);
    set_back_ = pause;
    live(4000, 220);
    worst_us_ = 0;
    live(4220, 400);
    EXPECT_LT(worst_us_, 1000) << pause;
  }
}

TEST(ExposureClock, StampsThatNoClockShowsAreRefused) {
  ExposureClock clock(0.005);
  for (int i = 0; i < 10; ++i) {
    clock.exposureOf({{}, 10.0 + 0.005 * i}, kEpoch + i * 5000);
  }
  for (const double hostile : {1e300, -1e300, 1e13, std::nan("")}) {
    EXPECT_FALSE(clock.exposureOf({{}, hostile}, kEpoch + 50'000));
    EXPECT_FALSE(clock.exposureOf({hostile, 10.05}, kEpoch + 50'000));
  }
  EXPECT_TRUE(clock.exposureOf({{}, 10.05}, kEpoch + 50'000));
}

TEST(ExposureClock, WithoutStampsTheLatencyIsWhatTheFileSays) {
  ExposureClock clock(0.007);
  EXPECT_EQ(clock.exposureOf({}, kEpoch), kEpoch - 7000);
}

TEST(FrameSequence, CountsWhatIsMissingAndRefusesWhatIsOld) {
  FrameSequence sequence;
  using Verdict = FrameSequence::Verdict;
  EXPECT_EQ(sequence.judge(10), Verdict::kNext);
  EXPECT_EQ(sequence.judge(11), Verdict::kNext);
  EXPECT_EQ(sequence.judge(11), Verdict::kOld);
  EXPECT_EQ(sequence.judge(14), Verdict::kNext);
  EXPECT_EQ(sequence.lost(), 2);
  EXPECT_EQ(sequence.judge(13), Verdict::kOld);
  EXPECT_EQ(sequence.judge(15), Verdict::kNext);
}

TEST(FrameSequence, NumbersThatBeginAnewAreFollowedAfterThree) {
  FrameSequence sequence;
  using Verdict = FrameSequence::Verdict;
  sequence.judge(1000);
  EXPECT_EQ(sequence.judge(1), Verdict::kOld);
  EXPECT_EQ(sequence.judge(2), Verdict::kOld);
  EXPECT_EQ(sequence.judge(3), Verdict::kRestart);
  EXPECT_EQ(sequence.judge(4), Verdict::kNext);
}

// Numbers of the last run are 1000; at which of these is the new run believed?
int restartAt(const std::vector<std::int64_t>& numbers) {
  FrameSequence sequence;
  sequence.judge(1000);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (sequence.judge(numbers[i]) == FrameSequence::Verdict::kRestart) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

TEST(FrameSequence, ARestartIsSeenThoughPacketsComeDoubledOrInAnotherOrder) {
  EXPECT_EQ(restartAt({1, 1, 2, 2, 3, 3}), 4);
  EXPECT_EQ(restartAt({2, 1, 4, 3, 6, 5}), 4) << "every second one overtaken";
  EXPECT_EQ(restartAt({1, 3, 2, 2, 4}), 4);
  EXPECT_EQ(restartAt({500, 1, 2, 3}), 3) << "a straggler is no beginning";
}

}  // namespace
}  // namespace roundabout::mocap_bridge
