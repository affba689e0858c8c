#pragma once

#include <optional>

namespace roundabout::app {

/// Real-time priorities of the processes of a flight: frames before plans.
inline constexpr int kFramePriority = 10;
inline constexpr int kPlannerPriority = 5;

/// Asks the system for what keeps this thread, and those it makes afterwards, on time: a real-time
/// priority and timers that do not wait for company. Goes on without what is not permitted, and
/// says so.
void requestRealTimePriority(int priority);

/// A thread's policy and priority, as sched_setscheduler(2) takes them.
struct Scheduling {
  int policy = 0;
  int priority = 0;
  bool operator==(const Scheduling&) const = default;
};
/// The same, but not for threads that such a thread makes; nothing if they inherit no real-time
/// priority anyway.
std::optional<Scheduling> keptToTheThread(const Scheduling& own);

/// Threads that this one makes from now on have an ordinary priority: those that compute for long
/// and must not hold up anybody who is on time.
void keepRealTimePriorityToThisThread();

/// Asks for memory that stays where it is.
void requestLockedMemory();

}  // namespace roundabout::app
