#include "cli/operator_commands.h"

#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "cli/order_delivery.h"
#include "cli/wall_clock.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/mission_t.hpp"

namespace roundabout::cli {

namespace {

using core::SafetyOrderKind;
using roundabout_msgs::fleet_status_t;

// The fleet answers at 5 Hz: this is several chances.
constexpr double kAnswerLimit_s = 1.5;

struct OrderOptions {
  std::string order;
  std::string vehicle;
  std::string lcm_url;
};

struct MissionOptions {
  std::string verb;
  std::string text;
  std::string lcm_url;
};

SafetyOrderKind orderCalled(const std::string& name) {
  static const std::map<std::string, SafetyOrderKind> kOrders{{"hold", SafetyOrderKind::kHold},
                                                              {"land", SafetyOrderKind::kLand},
                                                              {"kill", SafetyOrderKind::kKill},
                                                              {"resume", SafetyOrderKind::kResume}};
  return kOrders.at(name);
}

int sendOrder(const OrderOptions& options) {
  const std::string url = bus::resolveUrl(options.lcm_url);
  bus::LcmBus bus(url);
  core::SafetyOrder order;
  order.utime = wallTime();
  order.vehicle = options.vehicle;
  order.order = orderCalled(options.order);
  const Delivery delivery = deliver(bus, order);
  for (const std::string& line : delivery.obeyed) {
    fmt::print("{}\n", line);
  }
  for (const std::string& line : delivery.problems) {
    fmt::print(stderr, "roundabout: {}: {}\n", url, line);
  }
  return delivery.complete() ? 0 : 1;
}

int sendMission(const MissionOptions& options) {
  bus::LcmBus bus(bus::resolveUrl(options.lcm_url));
  roundabout_msgs::mission_t mission;
  mission.utime = wallTime();
  mission.num_points = 0;
  mission.mission_id = mission.utime;
  mission.verb = options.verb;
  mission.text = options.text;
  mission.seconds = std::numeric_limits<double>::quiet_NaN();

  int answers = 0;
  std::string refusal;
  const std::string id = std::to_string(mission.mission_id);
  bus::subscribe<fleet_status_t>(
      bus, bus::kFleetStatusChannel,
      [&](const fleet_status_t& status) {
        ++answers;
        for (const std::string& line : status.refusals) {
          refusal = line.find(id) == std::string::npos ? refusal : line;
        }
      },
      [](const bus::DecodeError&) {});
  bus::publish(bus, bus::kMissionChannel, mission);
  // The first status may have been under way before the fleet heard the mission.
  for (const double since_s = wallSeconds();
       answers < 3 && refusal.empty() && wallSeconds() - since_s < kAnswerLimit_s;) {
    bus.handle(std::chrono::milliseconds(50));
  }
  if (answers == 0) {
    fmt::print(stderr, "roundabout: no fleet is heard\n");
    return 1;
  }
  if (!refusal.empty()) {
    fmt::print(stderr, "roundabout: refused: {}\n", refusal);
    return 1;
  }
  return 0;
}

}  // namespace

void addOrderCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("order", "Order vehicles to hold, land, kill or resume");
  auto options = std::make_shared<OrderOptions>();
  command->add_option("order", options->order, "hold, land, kill (stop the motors) or resume")
      ->required()
      ->check(CLI::IsMember({"hold", "land", "kill", "resume"}));
  command->add_option("--vehicle", options->vehicle, "Default: all");
  command->add_option("--lcm-url", options->lcm_url, "Default: LCM_DEFAULT_URL");
  command->callback([options, &exit_status] { exit_status = sendOrder(*options); });
}

void addMissionCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("mission", "Give the fleet a step to fly");
  auto options = std::make_shared<MissionOptions>();
  command->add_option("verb", options->verb, "What to do")
      ->required()
      ->check(CLI::IsMember({"take_off", "spell", "hold", "land"}));
  command->add_option("text", options->text, "What to spell");
  command->add_option("--lcm-url", options->lcm_url, "Default: LCM_DEFAULT_URL");
  command->callback([options, &exit_status] {
    if ((options->verb == "spell") == options->text.empty()) {
      throw CLI::ValidationError("text", "is for spell, which needs it");
    }
    exit_status = sendMission(*options);
  });
}

}  // namespace roundabout::cli
