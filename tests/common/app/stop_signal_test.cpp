#include "common/app/stop_signal.h"

#include <atomic>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

namespace roundabout::app {
namespace {

bool readable(const StopSignal& stop) {
  pollfd waiting{stop.fileDescriptor(), POLLIN, 0};
  return poll(&waiting, 1, 0) == 1;
}

TEST(StopSignal, IsNotRequestedBeforeASignal) {
  StopSignal stop;
  EXPECT_FALSE(readable(stop));
  EXPECT_FALSE(stop.requested());
}

TEST(StopSignal, StaysRequestedAfterASignal) {
  StopSignal stop;
  raise(SIGINT);
  EXPECT_TRUE(stop.requested());
  EXPECT_TRUE(stop.requested());
}

TEST(StopSignal, CountsSignals) {
  StopSignal stop;
  raise(SIGINT);
  EXPECT_EQ(stop.count(), 1);
  raise(SIGINT);
  raise(SIGTERM);
  EXPECT_EQ(stop.count(), 3);
}

TEST(StopSignal, HearsWhatReachesAThreadThatIsOlder) {
  std::atomic<bool> over = false;
  std::thread older([&over] {
    while (!over) {
      std::this_thread::yield();
    }
  });
  {
    StopSignal stop;
    pthread_kill(older.native_handle(), SIGTERM);
    pollfd waiting{stop.fileDescriptor(), POLLIN, 0};
    EXPECT_EQ(poll(&waiting, 1, 5000), 1);
    EXPECT_EQ(stop.count(), 1);
  }
  over = true;
  older.join();
}

TEST(StopSignal, CountsAHangUpOnceAndOnlyIfItIsTheFirst) {
  StopSignal stop;
  raise(SIGHUP);
  EXPECT_EQ(stop.count(), 1);
  raise(SIGHUP);
  EXPECT_EQ(stop.count(), 1);
  raise(SIGINT);
  EXPECT_EQ(stop.count(), 2);
}

TEST(StopSignal, DoesNotHearAHangUpThatIsIgnored) {
  std::signal(SIGHUP, SIG_IGN);
  StopSignal stop;
  raise(SIGHUP);
  EXPECT_FALSE(stop.requested());
  std::signal(SIGHUP, SIG_DFL);
}

TEST(StopSignal, TheDescriptorIsReadableUntilTheSignalIsSeen) {
  StopSignal stop;
  raise(SIGTERM);
  EXPECT_TRUE(readable(stop));
  EXPECT_TRUE(stop.requested());
  EXPECT_FALSE(readable(stop));
}

TEST(StopSignal, HearsASignalToAProcessWithThreads) {
  StopSignal stop;
  std::thread other([] { kill(getpid(), SIGTERM); });
  other.join();
  EXPECT_TRUE(stop.requested());
}

TEST(StopSignal, ASignalThatNobodySawDoesNotEndTheProcessLater) {
  {
    StopSignal stop;
    raise(SIGTERM);
  }
  StopSignal next;
  EXPECT_FALSE(next.requested());
}

TEST(StopSignalDeathTest, SignalsEndTheProcessAgainAfterwards) {
  EXPECT_EXIT(
      {
        { StopSignal stop; }
        raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace roundabout::app
