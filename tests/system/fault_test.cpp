// What a flight does when one of its processes is killed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/typed.h"
#include "logs/flight.h"
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

  // Right after a planning tick, so that a planner which acts on ticks only is a tick late.
  void killSimulatorAfterATick() {
    waitUntil("a frame just after a tick",
              [this] { return heard().states.utime % 100'000 < 10'000; });
    killProcess({"sim"});
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

  // Both in time, as far as a busy machine lets them, and one of them on the dot.
  void expectCommandAfter(std::int8_t mode, double limit_s) const {
    const double first_s = silenceBefore("hex1", mode);
    const double second_s = silenceBefore("hex2", mode);
    EXPECT_LE(std::min(first_s, second_s), limit_s + 0.02);
    EXPECT_LE(std::max(first_s, second_s), limit_s + 0.1);
    EXPECT_GE(std::min(first_s, second_s), limit_s - 0.05);
  }
};

/// Where a vehicle was from a time on, as its log tells.
std::vector<Eigen::Vector3d> placesFrom(const logs::Flight& flight,
                                        const logs::FlightVehicle& vehicle, core::Utime from) {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t frame = flight.frameAt(from); frame < flight.frames.size(); ++frame) {
    if (vehicle.samples[frame].tracked) {
      places.push_back(vehicle.samples[frame].position_world_m);
    }
  }
  return places;
}

// Between bodies, at any height.
double closestGapM(const logs::Flight& flight) {
  const logs::FlightVehicle& a = flight.vehicles.at(0);
  const logs::FlightVehicle& b = flight.vehicles.at(1);
  double closest_m = std::numeric_limits<double>::infinity();
  for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
    const Eigen::Vector3d way =
        a.samples[frame].position_world_m - b.samples[frame].position_world_m;
    closest_m = std::min(closest_m, way.head<2>().norm() - a.body_radius_m - b.body_radius_m);
  }
  return closest_m;
}

TEST_F(Fault, AKilledPlannersVehicleLandsAndTheOtherGoesOn) {
  cli::ChildProcess& flight = startSwap("fleet: {step_timeout_s: 14.0}\n");
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

  const logs::Flight flown = logs::readFlight((out() / "flight.lcm").string());
  EXPECT_GT(closestGapM(flown), 0.0);
  const logs::FlightVehicle& hex2 = flown.vehicles.at(1);
  const core::Utime last_command = hex2.commands.back().value.utime;
  const Eigen::Vector3d left = placesFrom(flown, hex2, last_command).front();
  // It holds 0.3 s after the command, brakes from 1 m/s, and lands after 1 s.
  const auto after = placesFrom(flown, hex2, last_command + core::toUtime(1.3));
  ASSERT_FALSE(after.empty());
  EXPECT_LT((after.front() - left).head<2>().norm(), 1.0);
  for (const Eigen::Vector3d& place : after) {
    ASSERT_LT((place - after.front()).head<2>().norm(), 0.1) << "it stays where it stopped";
  }
  EXPECT_GT(after.front().z(), 0.5) << "it stood there before it landed";
  EXPECT_LT(after.back().z(), 0.1);
}

TEST_F(Fault, PlannersHoldAndLandWhenTheSimulatorIsKilled) {
  cli::ChildProcess& flight = startSwap();
  killSimulatorAfterATick();
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("sim: killed by signal 9 (Killed)")));
  expectCommandAfter(command_t::HOLD, 0.15);
  expectCommandAfter(command_t::LAND, 0.5);
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
  waitUntil("half a second of frames", [this] { return heard().frames > 100; });
  const auto heard_frames = static_cast<std::size_t>(heard().frames);
  killProcess({"lcm-logger"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("landing all: the logger died")));
  EXPECT_LT(heightOf("hex1"), 0.1);
  EXPECT_LT(heightOf("hex2"), 0.1);
  // What it had written, ten times a second, is there.
  EXPECT_GT(payloadsOf(out() / "flight.lcm").at("VEHICLE_STATES").size() + 60, heard_frames);
}

}  // namespace
}  // namespace roundabout::test
