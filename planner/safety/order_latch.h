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
    if (kind == core::SafetyOrderKind::kResume) {
      state_ = Latch::kNone;
      reason_.clear();
    } else {
      set(latchOf(kind), reasonOf(kind));
    }
  }

  /// As order(), for one that came late: never lowers the state.
  void raise(core::SafetyOrderKind kind) { fault(latchOf(kind), reasonOf(kind)); }

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
  static Latch latchOf(core::SafetyOrderKind kind) {
    switch (kind) {
      case core::SafetyOrderKind::kHold:
        return Latch::kHold;
      case core::SafetyOrderKind::kLand:
        return Latch::kLand;
      case core::SafetyOrderKind::kKill:
        return Latch::kKill;
      case core::SafetyOrderKind::kResume:
        break;
    }
    return Latch::kNone;
  }

  static const char* reasonOf(core::SafetyOrderKind kind) {
    switch (kind) {
      case core::SafetyOrderKind::kHold:
        return "ordered to hold";
      case core::SafetyOrderKind::kLand:
        return "ordered to land";
      case core::SafetyOrderKind::kKill:
        return "ordered to stop the motors";
      case core::SafetyOrderKind::kResume:
        break;
    }
    return "";
  }

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
