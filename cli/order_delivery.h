#pragma once

#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/core/command.h"

namespace roundabout::cli {

/// Wall-clock limits, seconds.
struct DeliveryLimits {
  double listen_s = 0.3;  ///< to everybody, for an order to all: three planner statuses
  double answer_s = 1.5;  ///< for the last planner to obey; without states some speak after 1 s
  double repeat_s = 0.05;
};

/// What became of an order, one line a vehicle.
struct Delivery {
  std::vector<std::string> obeyed;    ///< "hex1: holding, ordered to hold"
  std::vector<std::string> problems;  ///< who did not obey, or that nobody was heard

  bool complete() const { return problems.empty(); }
};

/// Sends a safety order at once, then again, with the same stamp, until every planner that it is
/// for says in its status that it obeyed it or a newer one (planner_status_t.order_utime; a kill
/// only once it is in mode KILLED) or time is up. A kill also goes to vehicles without a planner.
/// Who has to answer an order to all is whoever has a planner, is in the fleet's status or among
/// the vehicle states. The order's utime must be later than 0 and its own. The bus should be an
/// object made for this order: subscriptions last as long as their bus.
Delivery deliver(bus::Bus& bus, const core::SafetyOrder& order, const DeliveryLimits& limits = {});

}  // namespace roundabout::cli
