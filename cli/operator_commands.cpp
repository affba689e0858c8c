#include "cli/operator_commands.h"

#include <map>
#include <memory>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "cli/order_delivery.h"
#include "cli/wall_clock.h"
#include "common/bus/lcm_bus.h"

namespace roundabout::cli {

namespace {

using core::SafetyOrderKind;
struct OrderOptions {
  std::string order;
  std::string vehicle;
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

}  // namespace roundabout::cli
