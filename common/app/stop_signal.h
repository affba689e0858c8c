#pragma once

namespace roundabout::app {

/// SIGINT, SIGTERM and, unless it was ignored before (nohup), SIGHUP as a descriptor to poll,
/// instead of a handler. Make it before any thread: threads inherit that the signals are blocked,
/// and so do child processes, which have to unblock them. One thread at a time may use an object.
class StopSignal {
 public:
  /// Throws core::StartupError if the system has no descriptor left.
  StopSignal();
  /// Signals end the process again; those that came unseen are dropped.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// True from the first signal on.
  bool requested();
  /// How many signals have come so far. Equal ones that came between two calls count once, and
  /// SIGHUP counts only if it is the first: a terminal that closes sends several.
  int count();
  /// Readable when a signal has come that neither requested() nor count() has seen.
  int fileDescriptor() const { return descriptor_; }

 private:
  void drain();

  int descriptor_ = -1;
  int count_ = 0;
};

}  // namespace roundabout::app
