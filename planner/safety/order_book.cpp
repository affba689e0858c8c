#include "planner/safety/order_book.h"

namespace roundabout::planner {

namespace {

// Year 2200: a stamp beyond it is corrupt.
constexpr core::Utime kNoSuchTime = 7'258'118'400'000'000;

}  // namespace

const char* OrderBook::take(const core::SafetyOrder& order, bool flying, OrderLatch& latch) {
  const bool resume = order.order == core::SafetyOrderKind::kResume;
  const bool no_such_time = order.utime >= kNoSuchTime;
  if (resume && (order.utime < newest_ || no_such_time)) {
    latch.remark(no_such_time ? "a resume with a corrupt stamp was refused"
                              : "a resume older than the last order was refused");
    return "a resume that is older than the last order, or corrupt";
  }
  if (resume && order.utime > 0 && order.utime <= newest_resume_) {
    return nullptr;  // repeated: it lifts nothing that was latched since
  }
  if (resume) {
    newest_resume_ = order.utime;
    resumed_ = resumed_ || flying;
  }
  // An old order makes nothing less safe: a hold that is repeated until everybody holds must not
  // end a landing ordered since.
  if (order.utime > 0 && order.utime < newest_) {
    latch.raise(order.order);
    return nullptr;
  }
  if (!no_such_time) {
    newest_ = order.utime;
    obeyed_ = order.utime;
  }
  latch.order(order.order);
  return nullptr;
}

}  // namespace roundabout::planner
