#include "cli/order_delivery.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "cli/wall_clock.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/planner_mode.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::cli {

namespace {

using core::PlannerMode;

constexpr std::chrono::milliseconds kStep(10);

struct Planner {
  PlannerMode mode = PlannerMode::kNeverHeard;
  std::string reason;
  core::Utime order_utime = 0;

  std::string describe() const {
    return fmt::format("{}{}{}", core::nameOf(mode), reason.empty() ? "" : ", ", reason);
  }
};

/// Everybody who is heard of, by vehicle.
using Heard = std::map<std::string, Planner>;

/// A newer order has overtaken this one: repeating it would change nothing.
bool obeys(const Planner& planner, const core::SafetyOrder& order) {
  return planner.order_utime >= order.utime &&
         (order.order != core::SafetyOrderKind::kKill || planner.mode == PlannerMode::kKilled);
}

std::shared_ptr<Heard> listen(bus::Bus& bus) {
  // Shared, because the subscriptions outlive the delivery.
  const auto heard = std::make_shared<Heard>();
  const auto ignore = [](const bus::DecodeError&) {};
  bus::subscribePrefix<roundabout_msgs::planner_status_t>(
      bus, bus::kPlannerStatusPrefix,
      [heard](const roundabout_msgs::planner_status_t& status) {
        (*heard)[status.vehicle] = {static_cast<PlannerMode>(status.mode), status.reason,
                                    status.order_utime};
      },
      ignore);
  const auto meet = [heard](const std::string& vehicle) { heard->try_emplace(vehicle); };
  bus::subscribe<roundabout_msgs::fleet_status_t>(
      bus, bus::kFleetStatusChannel,
      [meet](const roundabout_msgs::fleet_status_t& status) {
        for (const auto& progress : status.vehicles) {
          meet(progress.vehicle);
        }
      },
      ignore);
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      bus, bus::kStatesChannel,
      [meet](const roundabout_msgs::vehicle_states_t& states) {
        for (const auto& state : states.vehicles) {
          meet(state.name);
        }
      },
      ignore);
  return heard;
}

/// As far as is known by now.
bool everybodyObeys(const Heard& heard, const core::SafetyOrder& order) {
  if (!order.vehicle.empty()) {
    const auto addressed = heard.find(order.vehicle);
    return addressed != heard.end() && obeys(addressed->second, order);
  }
  return !heard.empty() && std::all_of(heard.begin(), heard.end(), [&](const auto& entry) {
    return obeys(entry.second, order);
  });
}

std::string namesOf(const Heard& heard) {
  std::string names;
  for (const auto& [name, planner] : heard) {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}

Delivery judge(const Heard& heard, const core::SafetyOrder& order) {
  Delivery delivery;
  if (heard.empty()) {
    delivery.problems.emplace_back("no planner answered");
  } else if (!order.vehicle.empty() && !heard.contains(order.vehicle)) {
    delivery.problems.push_back(
        fmt::format("no vehicle {} (heard: {})", order.vehicle, namesOf(heard)));
  }
  for (const auto& [name, planner] : heard) {
    if (!order.vehicle.empty() && name != order.vehicle) {
      continue;
    }
    if (obeys(planner, order)) {
      delivery.obeyed.push_back(name + ": " + planner.describe());
    } else if (planner.mode == PlannerMode::kNeverHeard) {
      delivery.problems.push_back(name + ": its planner is not heard" +
                                  (order.order == core::SafetyOrderKind::kKill
                                       ? "; the vehicle itself was told to stop"
                                       : ""));
    } else {
      delivery.problems.push_back(name + " does not obey: " + planner.describe());
    }
  }
  return delivery;
}

}  // namespace

namespace {

/// Vehicles whose planner may be dead hear a kill themselves: they obey one whatever its stamp.
void killSilentOnes(bus::Bus& bus, const Heard& heard, const core::SafetyOrder& order) {
  for (const auto& [name, planner] : heard) {
    const bool addressed = order.vehicle.empty() || order.vehicle == name;
    if (addressed && planner.mode == PlannerMode::kNeverHeard) {
      core::Command kill;
      kill.vehicle = name;
      kill.mode = core::CommandMode::kKill;
      bus::publish(bus, bus::commandChannel(name), bus::toMessage(kill));
    }
  }
}

}  // namespace

Delivery deliver(bus::Bus& bus, const core::SafetyOrder& order, const DeliveryLimits& limits) {
  const auto send = [&] {
    bus::publish(bus, bus::kSafetyOrderChannel, bus::toMessage(order));
    return wallSeconds();
  };
  const double begin_s = send();  // before the subscriptions, which take LCM a moment
  const double listen_s = order.vehicle.empty() ? limits.listen_s : 0.0;
  const std::shared_ptr<Heard> heard = listen(bus);
  double sent_s = begin_s;
  for (double now_s = begin_s; now_s - begin_s < limits.answer_s; now_s = wallSeconds()) {
    bus.handle(kStep);
    if (everybodyObeys(*heard, order)) {
      if (now_s - begin_s >= listen_s) {
        break;
      }
    } else if (now_s - sent_s >= limits.repeat_s) {
      sent_s = send();
      if (order.order == core::SafetyOrderKind::kKill && now_s - begin_s >= limits.listen_s) {
        killSilentOnes(bus, *heard, order);
      }
    }
  }
  return judge(*heard, order);
}

}  // namespace roundabout::cli
