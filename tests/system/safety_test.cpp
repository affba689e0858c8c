// Orders, hostile messages and pushes while real processes fly.

#include <fstream>
#include <iterator>
#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/random.h"
#include "roundabout_msgs/mission_t.hpp"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using roundabout_msgs::fleet_status_t;
using roundabout_msgs::planner_status_t;
using testing::Contains;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class SafetyOrder : public FlightLab {
 protected:
  cli::ChildProcess& startSwap() {
    cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
    waitUntil("the swap", [this] { return heard().fleet.phase == fleet_status_t::GO; });
    return flight;
  }
  void order(const std::vector<std::string>& words) {
    std::vector<std::string> arguments{"order"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.insert(arguments.end(), {"--lcm-url", url()});
    ASSERT_TRUE(run("roundabout", arguments).status.clean());
  }
  void waitForMode(const std::string& vehicle, std::int8_t mode) {
    waitUntil(vehicle + " in mode " + std::to_string(mode),
              [&] { return modeOf(vehicle) == mode; });
  }
};

TEST_F(SafetyOrder, HoldStopsAllUntilResume) {
  cli::ChildProcess& flight = startSwap();
  order({"hold"});
  waitForMode("hex1", planner_status_t::HOLDING);
  waitForMode("hex2", planner_status_t::HOLDING);
  listenFor(std::chrono::milliseconds(1000));
  for (const auto& vehicle : heard().states.vehicles) {
    EXPECT_LT(std::hypot(vehicle.velocity[0], vehicle.velocity[1]), 0.1) << vehicle.name;
    EXPECT_GT(vehicle.position[2], 0.8) << vehicle.name;
  }
  order({"resume"});
  EXPECT_TRUE(finish(flight).status.clean());
}

TEST_F(SafetyOrder, LandBringsOneVehicleDownAndLeavesTheOtherFlying) {
  cli::ChildProcess& flight = startSwap();
  order({"land", "--vehicle", "hex2"});
  waitForMode("hex2", planner_status_t::LANDED);
  EXPECT_LT(heightOf("hex2"), 0.1);
  EXPECT_GT(heightOf("hex1"), 0.8);
  flight.signal(SIGINT);
  EXPECT_EQ(finish(flight).status.code, 130);
}

TEST_F(SafetyOrder, KillStopsTheMotorsEvenWhileHolding) {
  cli::ChildProcess& flight = startSwap();
  order({"hold"});
  waitForMode("hex1", planner_status_t::HOLDING);
  order({"kill"});
  waitForMode("hex1", planner_status_t::KILLED);
  waitUntil("all on the floor",
            [this] { return heightOf("hex1") < 0.05 && heightOf("hex2") < 0.05; });
  EXPECT_EQ(finish(flight).status.code, 1);
}

/// Sends what nobody should ever send, on every channel that anybody listens to, all through a
/// flight.
class HostileMessages : public FlightLab {
 protected:
  HostileMessages() {
    const auto ignore = [](const bus::DecodeError&) {};
    bus::subscribe<planner_status_t>(
        bus(), "PLANNER_STATUS_hex1",
        [this](const planner_status_t& status) {
          // Forged ones have no policy.
          rejected_by_hex1_ = status.policy.empty() ? rejected_by_hex1_ : status.rejected_messages;
        },
        ignore);
    bus::subscribe<fleet_status_t>(
        bus(), "FLEET_STATUS",
        [this](const fleet_status_t& status) {
          rejected_by_fleet_ = std::max(rejected_by_fleet_, status.rejected_messages);
        },
        ignore);
  }

  // Its last line says so.
  int rejectedBySim() const {
    std::ifstream log(out() / "logs" / "sim.log");
    const std::string text{std::istreambuf_iterator<char>(log), std::istreambuf_iterator<char>()};
    std::smatch match;
    return std::regex_search(text, match, std::regex(R"((\d+) messages refused)"))
               ? std::stoi(match[1])
               : -1;
  }

  int rejected_by_hex1_ = 0;
  int rejected_by_fleet_ = 0;

  void sendEverythingWrong() {
    const std::vector<std::string> channels{"VEHICLE_STATES",     "SAFETY_ORDER", "MISSION",
                                            "FLEET_STATUS",       "GOAL_hex1",    "COMMAND_hex1",
                                            "PLANNER_STATUS_hex1"};
    for (const std::string& channel : channels) {
      bus().publish(channel, randomBytes(1 + random_.index(300)));
      bus().publish(channel, {});
      roundabout_msgs::safety_order_t order{};
      order.vehicle = "nobody";
      order.order = 99;
      bus().publish(channel, bus::encode(order));
    }
    sendNumbersThatAreNone();
    sendOldAndUnknown();
    sendFrames();
    sendOrders();
    sendOthersStatuses();
  }

 private:
  std::vector<std::byte> randomBytes(std::size_t count) {
    std::vector<std::byte> bytes(count);
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(random_.index(256));
    }
    return bytes;
  }

  void sendNumbersThatAreNone() {
    core::Goal goal;
    goal.utime = heard().states.utime;
    goal.vehicle = "hex1";
    goal.goal_id = 1;
    goal.position_world_m = {kNaN, 0.0, 1.0};
    bus::publish(bus(), "GOAL_hex1", bus::toMessage(goal));
    core::Command command;
    command.utime = heard().states.utime;
    command.vehicle = "hex1";
    command.mode = core::CommandMode::kVelocity;
    command.velocity_world_mps.x() = kNaN;
    bus::publish(bus(), "COMMAND_hex1", bus::toMessage(command));
    roundabout_msgs::mission_t mission{};
    mission.verb = "formation";
    mission.num_points = 1;
    mission.points = {{kNaN, kNaN, kNaN}};
    bus::publish(bus(), "MISSION", mission);
  }

  void sendOldAndUnknown() {
    core::Goal goal;
    goal.utime = 1;
    goal.vehicle = "hex1";
    goal.phase = core::GoalPhase::kLand;
    bus::publish(bus(), "GOAL_hex1", bus::toMessage(goal));
    goal.utime = heard().states.utime;
    goal.vehicle = "stranger";
    bus::publish(bus(), "GOAL_hex1", bus::toMessage(goal));
    core::Command command;
    command.utime = 1;
    command.vehicle = "hex1";
    command.mode = core::CommandMode::kLand;
    bus::publish(bus(), "COMMAND_hex1", bus::toMessage(command));
    command.utime = heard().states.utime;
    command.vehicle = "stranger";
    bus::publish(bus(), "COMMAND_hex1", bus::toMessage(command));
    roundabout_msgs::mission_t mission{};
    mission.utime = heard().states.utime;
    mission.verb = "go_to";
    mission.vehicle = "stranger";
    mission.num_points = 1;
    mission.points = {{0.0, 0.0, 1.0}};
    bus::publish(bus(), "MISSION", mission);
    mission.utime = 1;
    mission.vehicle = "hex1";
    bus::publish(bus(), "MISSION", mission);
  }

  void sendFrames() {
    const roundabout_msgs::vehicle_states_t honest = heard().states;
    if (honest.vehicles.empty()) {
      return;
    }
    for (const core::Utime step : {-1'000'000L, 86'400'000'000L}) {
      roundabout_msgs::vehicle_states_t states = honest;
      states.utime += step;
      states.frame_number += step;
      bus::publish(bus(), "VEHICLE_STATES", states);
    }
    roundabout_msgs::vehicle_states_t states = honest;
    states.utime += 1;
    states.vehicles[0].position[0] = kNaN;
    bus::publish(bus(), "VEHICLE_STATES", states);
    states = honest;
    states.utime += 2;
    states.vehicles[0].name = "stranger";
    bus::publish(bus(), "VEHICLE_STATES", states);
  }

  void sendOrders() {
    roundabout_msgs::safety_order_t order{};
    order.utime = heard().states.utime;
    order.vehicle = "stranger";
    order.order = roundabout_msgs::safety_order_t::KILL;
    bus::publish(bus(), "SAFETY_ORDER", order);
    order.utime = 1;
    order.vehicle = "";
    order.order = roundabout_msgs::safety_order_t::RESUME;
    bus::publish(bus(), "SAFETY_ORDER", order);
  }

  void sendOthersStatuses() {
    planner_status_t status{};
    status.utime = 1;
    status.vehicle = "hex1";
    bus::publish(bus(), "PLANNER_STATUS_hex1", status);
    status.utime = heard().states.utime;
    status.vehicle = "hex2";
    status.distance_to_goal = kNaN;
    status.compute_time = kNaN;
    bus::publish(bus(), "PLANNER_STATUS_hex1", status);
    fleet_status_t fleet{};
    fleet.utime = 1;
    for (const std::int8_t phase : {fleet_status_t::DONE, fleet_status_t::FAILED}) {
      fleet.phase = phase;
      bus::publish(bus(), "FLEET_STATUS", fleet);
    }
  }

  core::RandomStream random_{5, "hostile"};
};

TEST_F(HostileMessages, AreRejectedAndCountedAndTheFlightGoesOn) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
  waitUntil("take-off", [this] { return heard().fleet.phase == fleet_status_t::TAKE_OFF; });
  while (!flight.exited()) {
    sendEverythingWrong();
    listenFor(std::chrono::milliseconds(20));
  }
  const Ended ended = finish(flight);
  EXPECT_TRUE(ended.status.clean()) << ended.status.describe();
  EXPECT_GT(rejected_by_hex1_, 100);
  EXPECT_GT(heard().planners.at("hex2").rejected_messages, 100);
  EXPECT_GT(rejected_by_fleet_, 100);
  EXPECT_GT(rejectedBySim(), 100);
}

class Push : public FlightLab {};

TEST_F(Push, TowardTheEdgeOfTheRoomIsAnsweredBeforeIt) {
  // hex1 flies along the wall at y = -2, which its body must not touch, and is pushed toward it and
  // back: speeding up again has to wait until it has braked in front of the wall.
  const std::string file = write("push.yaml", R"(name: push
room: {min_m: [-5, -2, 0], max_m: [5, 3, 3]}
vehicles:
  - {name: hex1, preferred_speed_mps: 1.0, start: {position_m: [-4, -1.2]}}
sim:
  start_area: {min_m: [-4, -1], max_m: [4, 2]}
  pushes:
    - {vehicle: hex1, at_s: 6.0, duration_s: 0.5, acceleration_mps2: [-1.5, -2.5]}
mission:
  - take_off
  - formation: {name: along, points: [[4, -1.2]], seconds: 0.5}
  - land
)");
  ASSERT_TRUE(finish(startFlight(file, {"--no-report"})).status.clean());
  const auto payloads = payloadsOf(out() / "flight.lcm");
  double lowest_m = 0.0;
  bool slowed_down = false;
  for (const std::string& payload : payloads.at("VEHICLE_STATES")) {
    roundabout_msgs::vehicle_states_t states;
    states.decode(payload.data(), 0, static_cast<int>(payload.size()));
    lowest_m = std::min(lowest_m, states.vehicles.at(0).position[1]);
  }
  for (const std::string& payload : payloads.at("PLANNER_STATUS_hex1")) {
    planner_status_t status;
    status.decode(payload.data(), 0, static_cast<int>(payload.size()));
    slowed_down = slowed_down || status.reason.find("edge of the room") != std::string::npos;
  }
  EXPECT_LT(lowest_m, -1.4) << "the push was not felt";
  EXPECT_GT(lowest_m, -2.0 + 0.35);
  EXPECT_TRUE(slowed_down);
}

}  // namespace
}  // namespace roundabout::test
