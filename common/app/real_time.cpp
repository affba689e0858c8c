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

std::optional<Scheduling> keptToTheThread(const Scheduling& own) {
  const bool inherited = own.policy == SCHED_FIFO || own.policy == SCHED_RR;
  return inherited ? std::optional(Scheduling{own.policy | SCHED_RESET_ON_FORK, own.priority})
                   : std::nullopt;
}

void keepRealTimePriorityToThisThread() {
  sched_param parameter{};
  if (sched_getparam(0, &parameter) != 0) {
    return;
  }
  if (const auto kept = keptToTheThread({sched_getscheduler(0), parameter.sched_priority})) {
    report(sched_setscheduler(0, kept->policy, &parameter) == 0,
           "ordinary priority of new threads");
  }
}

void requestLockedMemory() { report(mlockall(MCL_CURRENT | MCL_FUTURE) == 0, "locked memory"); }

}  // namespace roundabout::app
