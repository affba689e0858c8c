// Orders, hostile messages and pushes while real processes fly.

#include <limits>

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
    roundabout_msgs::vehicle_states_t states = heard().states;
    states.utime -= 1'000'000;
    bus::publish(bus(), "VEHICLE_STATES", states);
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
    planner_status_t status{};
    status.utime = 1;
    status.vehicle = "hex1";
    bus::publish(bus(), "PLANNER_STATUS_hex1", status);
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
  // hex1's own status is drowned in forged ones.
  EXPECT_GT(heard().planners.at("hex2").rejected_messages, 100);
}

class Push : public FlightLab {};

TEST_F(Push, TowardTheEdgeOfTheRoomIsAnsweredBeforeIt) {
  // hex1 flies along the wall at y = -2, which its body must not touch, and is pushed toward it.
  const std::string file = write("push.yaml", R"(name: push
room: {min_m: [-5, -2, 0], max_m: [5, 3, 3]}
vehicles:
  - {name: hex1, preferred_speed_mps: 1.0, start: {position_m: [-4, -1.2]}}
sim:
  start_area: {min_m: [-4, -1], max_m: [4, 2]}
  pushes:
    - {vehicle: hex1, at_s: 6.0, duration_s: 0.5, acceleration_mps2: [0, -2.5]}
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
