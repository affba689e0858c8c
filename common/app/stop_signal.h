#pragma once

namespace roundabout::app {

/// SIGINT and SIGTERM as a descriptor to poll, instead of a handler. Make it before any thread:
/// threads inherit that the signals are blocked.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// True from the first signal on.
  bool requested();
  /// How many signals have come so far.
  int count();
  int fileDescriptor() const { return descriptor_; }

 private:
  void drain();

  int descriptor_ = -1;
  int count_ = 0;
};

}  // namespace roundabout::app
