#pragma once

namespace roundabout::app {

/// Real-time priorities of the processes of a flight: frames before plans.
inline constexpr int kFramePriority = 10;
inline constexpr int kPlannerPriority = 5;

/// Asks the system for what keeps this thread, and those it makes afterwards, on time: a real-time
/// priority and timers that do not wait for company. Goes on without what is not permitted, and
/// says so.
void requestRealTimePriority(int priority);

/// Threads that this one makes from now on have an ordinary priority: those that compute for long
/// and must not hold up anybody who is on time.
void keepRealTimePriorityToThisThread();

/// Asks for memory that stays where it is.
void requestLockedMemory();

}  // namespace roundabout::app
