#include "common/app/real_time.h"

#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/prctl.h>

namespace roundabout::app {

namespace {

void report(bool granted, const char* what) {
  if (!granted) {
    spdlog::info("not permitted, going on without: {}", what);
  }
}

}  // namespace

void requestRealTimePriority(int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  report(sched_setscheduler(0, SCHED_FIFO, &parameter) == 0, "real-time priority");
  report(prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) == 0, "exact timers");
}

void keepRealTimePriorityToThisThread() {
  sched_param parameter{};
  const int policy = sched_getscheduler(0);
  if (policy != SCHED_FIFO || sched_getparam(0, &parameter) != 0) {
    return;
  }
  report(sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &parameter) == 0,
         "ordinary priority of new threads");
}

void requestLockedMemory() { report(mlockall(MCL_CURRENT | MCL_FUTURE) == 0, "locked memory"); }

}  // namespace roundabout::app
