#include "common/app/real_time.h"

#include <thread>

#include <gtest/gtest.h>
#include <sched.h>

namespace roundabout::app {
namespace {

int policyOfANewThread() {
  int policy = -1;
  std::thread([&policy] { policy = sched_getscheduler(0); }).join();
  return policy;
}

TEST(RealTime, GoesToNewThreadsUntilItIsKeptToTheThread) {
  std::thread([] {
    requestRealTimePriority(1);
    if (sched_getscheduler(0) != SCHED_FIFO) {
      GTEST_SKIP() << "real-time priority is not permitted here";
    }
    EXPECT_EQ(policyOfANewThread(), SCHED_FIFO);
    keepRealTimePriorityToThisThread();
    EXPECT_EQ(policyOfANewThread(), SCHED_OTHER);
    EXPECT_EQ(sched_getscheduler(0), SCHED_FIFO | SCHED_RESET_ON_FORK);
  }).join();
}

TEST(RealTime, IsNotGivenToAThreadThatHasNone) {
  std::thread([] {
    keepRealTimePriorityToThisThread();
    EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  }).join();
}

}  // namespace
}  // namespace roundabout::app
