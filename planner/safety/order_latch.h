#pragma once

#include <string>

#include "common/core/command.h"

namespace roundabout::planner {

/// What the vehicle is held to until an operator's RESUME, in rising severity.
enum class Latch { kNone, kHold, kLand, kKill };

/// Remembers operators' orders and the faults that only an operator can clear.
///
///   state  | HOLD | LAND | KILL | RESUME | fault hold | fault land
///   none   | hold | land | kill | none   | hold       | land
///   hold   | hold | land | kill | none   | hold       | land
///   land   | hold | land | kill | none   | land       | land
///   kill   | kill | kill | kill | none   | kill       | kill
class OrderLatch {
 public:
  void order(core::SafetyOrderKind kind) {
    switch (kind) {
      case core::SafetyOrderKind::kHold:
        set(Latch::kHold, "ordered to hold");
        break;
      case core::SafetyOrderKind::kLand:
        set(Latch::kLand, "ordered to land");
        break;
      case core::SafetyOrderKind::kKill:
        set(Latch::kKill, "ordered to stop the motors");
        break;
      case core::SafetyOrderKind::kResume:
        state_ = Latch::kNone;
        reason_.clear();
        break;
    }
  }

  /// A fault never lowers the state.
  void fault(Latch severity, const std::string& reason) {
    if (severity > state_) {
      set(severity, reason);
    }
  }

  /// Adds something that the operator should know to the reason, once.
  void remark(const std::string& text) {
    if (state_ != Latch::kNone && reason_.find(text) == std::string::npos) {
      reason_ += "; " + text;
    }
  }

  Latch state() const { return state_; }
  const std::string& reason() const { return reason_; }

 private:
  void set(Latch state, const std::string& reason) {
    if (state_ != Latch::kKill) {
      state_ = state;
      reason_ = reason;
    }
  }

  Latch state_ = Latch::kNone;
  std::string reason_;
};

}  // namespace roundabout::planner
