#include <gmock/gmock.h>

#include "common/bus/messages.h"
#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "logs/files.h"
#include "logs/flight.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::HasSubstr;

class ReadFlightTest : public testing::Test {
 protected:
  ReadFlightTest() {
    synthetic_.vehicles = {{"hex1", straight({0, 0, 1}, {5, 0, 1}, 1.0)},
                           {"hex2", standing({0, 3, 1})}};
    synthetic_.formations = {{"C", 1.0, 5.0, 7.0, {{5, 0, 1}, {0, 3, 1}}}};
  }

  Flight read(const std::string& experiment_file = "") {
    synthetic_.write(log());
    return readFlight(log(), experiment_file);
  }
  std::string log() const { return folder_.file("flight.lcm"); }

  test::ScratchFolder folder_;
  SyntheticFlight synthetic_;
};

TEST_F(ReadFlightTest, DecodesEveryKindOfMessage) {
  const Flight flight = read();
  EXPECT_EQ(flight.frames.size(), 2001u);
  ASSERT_EQ(flight.vehicles.size(), 2u);
  const FlightVehicle& vehicle = flight.vehicles[0];
  EXPECT_EQ(vehicle.name, "hex1");
  EXPECT_NEAR(vehicle.samples[400].position_world_m.x(), 2.0, 1e-9);
  EXPECT_NEAR(vehicle.samples[400].velocity_world_mps.x(), 1.0, 1e-6);
  EXPECT_TRUE(vehicle.samples[400].tracked);
  EXPECT_EQ(vehicle.goals.size(), 1u) << "a repeated goal counts once";
  EXPECT_EQ(vehicle.commands.size(), 101u);
  EXPECT_EQ(vehicle.statuses.size(), 101u);
  EXPECT_EQ(flight.fleet.size(), 51u);
  EXPECT_TRUE(flight.rejected.empty());
  EXPECT_TRUE(flight.damage.empty());
}

TEST_F(ReadFlightTest, TakesRadiiFromTheExperimentBesideTheLog) {
  config::Experiment experiment = synthetic_.experiment(0.8);
  experiment.vehicles[1].body_radius_m = 0.2;
  writeFile(folder_.file("experiment.yaml"), config::toYaml(experiment));
  const Flight flight = read();
  EXPECT_EQ(flight.vehicles[1].body_radius_m, 0.2);
  EXPECT_EQ(flight.vehicles[1].preferred_speed_mps, 0.8);
  EXPECT_THAT(flight.experiment_note, HasSubstr("experiment.yaml"));
}

TEST_F(ReadFlightTest, SaysThatRadiiAreDefaultsWithoutAnExperiment) {
  const Flight flight = read();
  EXPECT_EQ(flight.vehicles[0].body_radius_m, config::Vehicle().body_radius_m);
  EXPECT_THAT(flight.experiment_note, HasSubstr("are defaults"));
}

TEST_F(ReadFlightTest, RefusesAGivenExperimentThatIsMissing) {
  EXPECT_THROW(read(folder_.file("nowhere.yaml")), core::StartupError);
}

TEST_F(ReadFlightTest, CountsMessagesOfNoUseByChannel) {
  synthetic_.write(log());
  const std::string whole = readFile(log());
  {
    LogWriter writer(log());
    roundabout_msgs::command_t command{};
    command.vehicle = "ghost";
    writer.write(1, "COMMAND_ghost", command);
    command.vehicle = "hex2";
    writer.write(2, "COMMAND_hex1", command);
    writer.writeBytes(3, "COMMAND_hex1", std::as_bytes(std::span("garbage, certainly")));
    writer.write(4, "FLEET_STATUS", command);
  }
  writeFile(log(), readFile(log()) + whole);
  const Flight flight = readFlight(log());
  ASSERT_EQ(flight.rejected.size(), 3u);
  EXPECT_EQ(flight.rejected[0].channel, "COMMAND_ghost");
  EXPECT_EQ(flight.rejected[0].reason, "unknown vehicle");
  EXPECT_EQ(flight.rejected[1].channel, "COMMAND_hex1");
  EXPECT_EQ(flight.rejected[1].count, 2);
  EXPECT_EQ(flight.rejected[2].reason, "wrong fingerprint");
  EXPECT_EQ(flight.vehicles[0].commands.size(), 101u);
}

TEST_F(ReadFlightTest, TakesARepeatedOrderForOne) {
  const std::string log = folder_.file("orders.lcm");
  {
    LogWriter writer(log);
    const core::SafetyOrder first{100, "", core::SafetyOrderKind::kHold};
    const core::SafetyOrder second{200, "hex1", core::SafetyOrderKind::kLand};
    for (const core::SafetyOrder& order : {first, second, first, second}) {
      writer.write(1, "SAFETY_ORDER", bus::toMessage(order));
    }
  }
  const Flight flight = readFlight(log);
  ASSERT_EQ(flight.safety_orders.size(), 2U);
  EXPECT_EQ(flight.safety_orders[1].value.vehicle, "hex1");
}

TEST_F(ReadFlightTest, LeavesOutFramesThatAreOlderThanTheOneBefore) {
  synthetic_.write(log());
  const std::string once = readFile(log());
  writeFile(log(), once + once);
  const Flight flight = readFlight(log());
  EXPECT_EQ(flight.frames.size(), 2001u);
  EXPECT_EQ(flight.frames_out_of_order, 2001);
  EXPECT_EQ(flight.vehicles[0].samples.size(), 2001u);
}

/// A frame with hex1 alone, and a status of the fleet.
void writeMoment(LogWriter& writer, core::Utime log_utime, core::Utime utime, double x_m) {
  core::VehicleState hex1;
  hex1.name = "hex1";
  hex1.tracked = true;
  hex1.position_world_m = {x_m, 0.0, 1.0};
  writer.write(log_utime, bus::kStatesChannel, bus::toMessage({utime, 0, {hex1}}));
  roundabout_msgs::fleet_status_t status{};
  status.utime = utime;
  status.phase = roundabout_msgs::fleet_status_t::GO;
  writer.write(log_utime + 1, bus::kFleetStatusChannel, status);
}

TEST_F(ReadFlightTest, AFrameADayAheadCostsNoOtherFrame) {
  {
    LogWriter writer(log());
    for (int k = 1; k <= 100; ++k) {
      writeMoment(writer, k * 5000, k * 5000 + (k == 50 ? 86'400'000'000 : 0), k);
    }
  }
  const Flight flight = readFlight(log());
  EXPECT_EQ(flight.frames.size(), 99u);
  EXPECT_EQ(flight.frames_out_of_order, 1);
  EXPECT_EQ(flight.vehicles[0].samples.back().position_world_m.x(), 100.0);
  EXPECT_EQ(flight.fleet.size(), 99u) << "nor does a status a day ahead";
  ASSERT_EQ(flight.rejected.size(), 1u);
  EXPECT_EQ(flight.rejected[0].channel, "FLEET_STATUS");
}

TEST_F(ReadFlightTest, AFirstFrameADayAheadCostsNoOtherFrame) {
  {
    LogWriter writer(log());
    for (int k = 1; k <= 100; ++k) {
      writeMoment(writer, k * 5000, k * 5000 + (k == 1 ? 86'400'000'000 : 0), k);
    }
  }
  EXPECT_EQ(readFlight(log()).frames.size(), 99u);
}

TEST_F(ReadFlightTest, APauseOfTheCamerasCostsNoFrame) {
  {
    LogWriter writer(log());
    for (int k = 1; k <= 100; ++k) {
      writeMoment(writer, k * 5000, k * 5000 + (k > 50 ? 700'000 : 0), k);
    }
  }
  const Flight flight = readFlight(log());
  EXPECT_EQ(flight.frames.size(), 100u);
  EXPECT_EQ(flight.frames_out_of_order, 0);
}

TEST_F(ReadFlightTest, OfTwoFlightsInALogTheLongerOneIsRead) {
  {
    LogWriter writer(log());
    for (int k = 1; k <= 60; ++k) {
      writeMoment(writer, k * 5000, 1'000'000 + k * 5000, 1.0);
    }
    for (int k = 1; k <= 100; ++k) {
      writeMoment(writer, 2'000'000 + k * 5000, k * 5000, 2.0);
    }
  }
  const Flight flight = readFlight(log());
  EXPECT_EQ(flight.frames.size(), 100u);
  EXPECT_EQ(flight.frames_out_of_order, 60);
  EXPECT_EQ(flight.vehicles[0].samples.front().position_world_m.x(), 2.0);
  EXPECT_EQ(flight.fleet.size(), 100u);
}

TEST_F(ReadFlightTest, KnowsRealTimeByTheLogWhenNothingElseSaysIt) {
  EXPECT_FALSE(read().realTime());
  synthetic_.wall_clock_per_data = 1.0;
  EXPECT_TRUE(read().realTime());
}

}  // namespace
}  // namespace roundabout::logs
