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

TEST(RealTime, PolicyAndPriorityStayWhileNewThreadsGetNone) {
  for (const int policy : {SCHED_FIFO, SCHED_RR}) {
    const auto kept = keptToTheThread({policy, 7});
    EXPECT_EQ(kept, (Scheduling{policy | SCHED_RESET_ON_FORK, 7}));
    EXPECT_EQ(keptToTheThread(*kept), std::nullopt) << "it is so already";
  }
  EXPECT_EQ(keptToTheThread({SCHED_OTHER, 0}), std::nullopt);
}

// The kernel's part of it, with a policy that needs no permission.
TEST(RealTime, TheKernelTakesThePolicyThatIsNotInherited) {
  std::thread([] {
    const sched_param parameter{};
    ASSERT_EQ(sched_setscheduler(0, SCHED_BATCH | SCHED_RESET_ON_FORK, &parameter), 0);
    EXPECT_EQ(sched_getscheduler(0), SCHED_BATCH | SCHED_RESET_ON_FORK);
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
