#include "cli/flight_monitor.h"

#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/mission_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::cli {
namespace {

using roundabout_msgs::fleet_status_t;
using roundabout_msgs::planner_status_t;
using testing::ElementsAre;
using testing::Pair;

core::VehicleState vehicleAt(const std::string& name, double x_m, double z_m = 1.0) {
  core::VehicleState state;
  state.name = name;
  state.position_world_m = {x_m, 0.0, z_m};
  state.tracked = true;
  return state;
}

class FlightMonitorTest : public testing::Test {
 protected:
  FlightMonitorTest() {
    config::Experiment experiment;
    experiment.vehicles.resize(2);
    experiment.vehicles[0].name = "hex1";
    experiment.vehicles[0].body_radius_m = 0.3;
    experiment.vehicles[1].name = "hex2";
    experiment.vehicles[1].body_radius_m = 0.2;
    FlightMonitor::Events events;
    events.first_state = [this] { ++first_states_; };
    events.fleet_heard = [this] { ++fleets_heard_; };
    events.planner_heard = [this](const std::string& vehicle, bool on_floor) {
      planners_heard_.emplace_back(vehicle, on_floor);
    };
    monitor_ = std::make_unique<FlightMonitor>(bus_, experiment, std::move(events));
  }

  void publishFrame(core::Utime utime, std::vector<core::VehicleState> vehicles) {
    bus::publish(bus_, bus::kStatesChannel, bus::toMessage({utime, 0, std::move(vehicles)}));
    bus_.handle({});
  }

  /// Empty ones, ten a second.
  void publishFrames(core::Utime first, core::Utime last) {
    for (core::Utime utime = first; utime <= last; utime += 100'000) {
      publishFrame(utime, {});
    }
  }

  void publishMode(const std::string& vehicle, std::int8_t mode) {
    planner_status_t status{};
    status.vehicle = vehicle;
    status.mode = mode;
    bus::publish(bus_, bus::plannerStatusChannel(vehicle), status);
    bus_.handle({});
  }

  void publishFleet(std::int8_t phase, int num_steps = 7) {
    fleet_status_t status{};
    status.phase = phase;
    status.formation = "D";
    status.step = 2;
    status.num_steps = num_steps;
    status.vehicles_at_goal = 1;
    bus::publish(bus_, bus::kFleetStatusChannel, status);
    bus_.handle({});
  }

  bus::MemoryBus bus_{std::make_shared<bus::MemoryNetwork>()};
  std::unique_ptr<FlightMonitor> monitor_;
  int first_states_ = 0;
  int fleets_heard_ = 0;
  std::vector<std::pair<std::string, bool>> planners_heard_;
};

TEST_F(FlightMonitorTest, KeepsTheClosestSeparationOfBodies) {
  publishFrame(1'000'000, {vehicleAt("hex1", 0.0), vehicleAt("hex2", 3.0)});
  publishFrame(1'005'000, {vehicleAt("hex1", 0.0), vehicleAt("hex2", 2.0)});
  publishFrame(1'010'000, {vehicleAt("hex1", 0.0), vehicleAt("hex2", 4.0)});
  EXPECT_NEAR(monitor_->progress().closest_separation_m, 1.5, 1e-12);
}

TEST_F(FlightMonitorTest, MeasuresSeparationInThePlane) {
  publishFrame(1'000'000, {vehicleAt("hex1", 0.0, 0.0), vehicleAt("hex2", 1.0, 9.0)});
  EXPECT_NEAR(monitor_->progress().closest_separation_m, 0.5, 1e-12);
}

TEST_F(FlightMonitorTest, LeavesOutWhatIsNotTrackedOrNotOfTheExperiment) {
  core::VehicleState hidden = vehicleAt("hex2", 0.1);
  hidden.tracked = false;
  publishFrame(1'000'000, {vehicleAt("hex1", 0.0), hidden, vehicleAt("chair", 0.0)});
  EXPECT_EQ(monitor_->progress().closest_separation_m, std::numeric_limits<double>::infinity());
}

TEST_F(FlightMonitorTest, TellsTheFirstStateOnceAndMeasuresDataTime) {
  publishFrames(1'000'000, 3'500'000);
  EXPECT_EQ(first_states_, 1);
  EXPECT_DOUBLE_EQ(monitor_->progress().elapsed_s(), 2.5);
}

TEST_F(FlightMonitorTest, IsNotMisledByAFrameADayAhead) {
  publishFrames(1'000'000, 1'500'000);
  publishFrame(86'400'000'000, {vehicleAt("hex1", 0.0), vehicleAt("hex2", 0.0)});
  publishFrames(1'600'000, 2'000'000);
  EXPECT_DOUBLE_EQ(monitor_->progress().elapsed_s(), 1.0);
  EXPECT_EQ(monitor_->progress().closest_separation_m, std::numeric_limits<double>::infinity());
}

TEST_F(FlightMonitorTest, MeasuresTimeAnewWhenTheSourceIsStartedAnew) {
  publishFrames(50'000'000, 51'000'000);
  publishFrames(1'000'000, 3'000'000);
  EXPECT_EQ(first_states_, 1);
  EXPECT_LE(monitor_->progress().elapsed_s(), 2.0);
  EXPECT_EQ(monitor_->progress().last_utime, 3'000'000);
}

TEST_F(FlightMonitorTest, TellsWhoIsOnTheFloor) {
  publishMode("hex1", planner_status_t::FLYING);
  publishMode("hex2", planner_status_t::LANDED);
  publishMode("hex1", planner_status_t::KILLED);
  EXPECT_THAT(planners_heard_,
              ElementsAre(Pair("hex1", false), Pair("hex2", true), Pair("hex1", true)));
}

TEST_F(FlightMonitorTest, KnowsWhenTheMissionIsOverInTheAir) {
  EXPECT_FALSE(monitor_->missionOver());
  publishFleet(fleet_status_t::HOLD);
  EXPECT_FALSE(monitor_->missionOver());
  publishFleet(fleet_status_t::DONE);
  EXPECT_FALSE(monitor_->missionOver()) << "it landed them itself";
  publishFleet(fleet_status_t::IDLE);
  EXPECT_TRUE(monitor_->missionOver());
  EXPECT_EQ(fleets_heard_, 3);
}

TEST_F(FlightMonitorTest, TakesNoMissionForOverThatIsSteeredByMessage) {
  publishFleet(fleet_status_t::IDLE, 0);
  EXPECT_FALSE(monitor_->missionOver()) << "the file has none";
  bus_.publish("MISSION", {});
  publishFleet(fleet_status_t::IDLE);
  EXPECT_TRUE(monitor_->missionOver()) << "that was no mission";
  bus::publish(bus_, "MISSION", roundabout_msgs::mission_t{});
  publishFleet(fleet_status_t::IDLE);
  EXPECT_FALSE(monitor_->missionOver()) << "somebody had a word with the fleet";
}

TEST_F(FlightMonitorTest, SurvivesBytesThatAreNoMessage) {
  const std::vector<std::byte> garbage(50, std::byte{0xA5});
  for (const char* channel : {"VEHICLE_STATES", "FLEET_STATUS", "PLANNER_STATUS_hex1"}) {
    bus_.publish(channel, garbage);
  }
  EXPECT_EQ(bus_.handle({}), 3);
  EXPECT_EQ(first_states_ + fleets_heard_, 0);
}

TEST_F(FlightMonitorTest, DescribesTheFlightInOneLine) {
  publishFrame(1'000'000, {vehicleAt("hex1", 0.0), vehicleAt("hex2", 2.0)});
  publishFleet(fleet_status_t::GO);
  publishFrames(1'100'000, 5'000'000);
  EXPECT_EQ(describe(monitor_->progress(), 0.5),
            "go D (step 3 of 7), 1 of 2 at goal, closest 1.50 m, 4.0 s, 8.0x real time");
}

TEST_F(FlightMonitorTest, DescribesAPhaseThatItDoesNotKnow) {
  publishFleet(-3);
  EXPECT_THAT(describe(monitor_->progress(), 0.0), testing::StartsWith("unknown"));
}

}  // namespace
}  // namespace roundabout::cli
