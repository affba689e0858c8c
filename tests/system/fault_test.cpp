// What a flight does when one of its processes is killed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/typed.h"
#include "logs/reading/event_log.h"
#include "roundabout_msgs/goal_t.hpp"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using roundabout_msgs::command_t;
using roundabout_msgs::fleet_status_t;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class Fault : public FlightLab {
 protected:
  // Both are on their way to each other's place.
  cli::ChildProcess& startSwap(const std::string& more = "") {
    cli::ChildProcess& flight = startFlight(twoSwap(more), {"--real-time"});
    waitUntil("the swap", [this] { return heard().fleet.phase == fleet_status_t::GO; });
    return flight;
  }

  // Wall clock between the last state and the first command of a mode, as the logger saw them. s.
  double silenceBefore(const std::string& vehicle, std::int8_t mode) const {
    core::Utime last_state = 0;
    const logs::EventLog log((out() / "flight.lcm").string());
    for (const logs::Event event : log) {
      if (event.channel == "VEHICLE_STATES") {
        last_state = event.log_utime;
      }
    }
    for (const logs::Event event : log) {
      command_t command;
      if (event.channel == "COMMAND_" + vehicle && event.log_utime > last_state &&
          bus::decode(event.payload, command) == nullptr && command.mode == mode) {
        return core::toSeconds(event.log_utime - last_state);
      }
    }
    return std::numeric_limits<double>::infinity();
  }
};

TEST_F(Fault, AKilledPlannersVehicleLandsAndTheOtherGoesOn) {
  cli::ChildProcess& flight = startSwap("fleet: {step_timeout_s: 8.0}\n");
  killProcess({"planner", "hex2"});
  waitUntil("hex1 at its goal",
            [this] { return heard().fleet.vehicles.at(0).at_goal && heightOf("hex1") > 0.5; });
  waitUntil("hex2 on the floor", [this] { return heightOf("hex2") < 0.1; });
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("planner_hex2: killed by signal 9 (Killed)")));
  EXPECT_THAT(ended.lines, Contains(HasSubstr("planner of hex2 silent")));
  EXPECT_THAT(ended.lines, Contains(HasSubstr("no bodies touched")));
  EXPECT_THAT(leftRunning(), IsEmpty());
}

TEST_F(Fault, PlannersHoldAndLandWhenTheSimulatorIsKilled) {
  cli::ChildProcess& flight = startSwap();
  killProcess({"sim"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("sim: killed by signal 9 (Killed)")));
  for (const char* vehicle : {"hex1", "hex2"}) {
    // A planner speaks ten times a second.
    EXPECT_LE(silenceBefore(vehicle, command_t::HOLD), 0.15 + 0.1) << vehicle;
    EXPECT_LE(silenceBefore(vehicle, command_t::LAND), 0.5 + 0.1) << vehicle;
  }
  EXPECT_THAT(leftRunning(), IsEmpty());
}

TEST_F(Fault, VehiclesStayAtTheirGoalsWithoutFleetAndANewFleetTakesOver) {
  cli::ChildProcess& flight = startSwap();
  killProcess({"fleet"});
  const auto at_goal = [this](const std::string& vehicle) {
    const auto found = heard().planners.find(vehicle);
    return found != heard().planners.end() &&
           found->second.mode == roundabout_msgs::planner_status_t::AT_GOAL &&
           found->second.distance_to_goal < 0.2 && found->second.goal_phase == 1;
  };
  waitUntil("both at their goals", [&] { return at_goal("hex1") && at_goal("hex2"); });
  listenFor(std::chrono::milliseconds(1000));
  EXPECT_TRUE(at_goal("hex1") && at_goal("hex2"));
  start("fleet", {"--config", (out() / "experiment.yaml").string(), "--lcm-url", url()});
  const Ended ended = finish(flight);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("fleet: killed by signal 9 (Killed)")));
  EXPECT_TRUE(ended.status.clean()) << ended.status.describe();
  EXPECT_LT(heightOf("hex1"), 0.1);
}

TEST_F(Fault, AllLandWhenNoNewFleetTakesOver) {
  cli::ChildProcess& flight = startSwap();
  killProcess({"fleet"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("landing all: no new fleet took over")));
  EXPECT_LT(heightOf("hex1"), 0.1);
  EXPECT_LT(heightOf("hex2"), 0.1);
}

TEST_F(Fault, AllLandWhenTheLoggerIsKilled) {
  cli::ChildProcess& flight = startSwap();
  killProcess({"lcm-logger"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("landing all: the logger died")));
  EXPECT_LT(heightOf("hex1"), 0.1);
  EXPECT_LT(heightOf("hex2"), 0.1);
}

}  // namespace
}  // namespace roundabout::test
