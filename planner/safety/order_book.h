#pragma once

#include "common/core/command.h"
#include "planner/safety/order_latch.h"

namespace roundabout::planner {

/// Safety orders in time: which of them reach the latch. What makes the vehicle safer is obeyed
/// whatever its time stamp; only a RESUME has to be new.
class OrderBook {
 public:
  /// Takes an order for this vehicle. `flying`: frames have come, so that a RESUME is one of this
  /// flight. Returns why it was refused; nullptr: it was not.
  const char* take(const core::SafetyOrder& order, bool flying, OrderLatch& latch);

  /// utime of the order obeyed last; 0: none.
  core::Utime obeyed() const { return obeyed_; }
  /// An operator has ordered RESUME since the first frame.
  bool resumed() const { return resumed_; }
  /// A new epoch begins: it was not resumed in this one.
  void beginAnew() { resumed_ = false; }

 private:
  core::Utime newest_ = 0;
  core::Utime newest_resume_ = 0;
  core::Utime obeyed_ = 0;  // the last to arrive
  bool resumed_ = false;
};

}  // namespace roundabout::planner
