// Flights of real processes behind the shield, in lockstep: what their logs say.

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "logs/metrics/metrics.h"
#include "roundabout_msgs/planner_status_t.hpp"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using roundabout_msgs::planner_status_t;

// Four fly straight through the middle of a square; `more` is appended.
std::string fourCross(const std::string& more = "") {
  return R"(name: four_cross
room: {min_m: [-6, -6, 0], max_m: [6, 6, 3]}
vehicle_defaults: {preferred_speed_mps: 1.0}
vehicles:
  - {name: hex1, start: {position_m: [-3, 0]}}
  - {name: hex2, start: {position_m: [3, 0]}}
  - {name: hex3, start: {position_m: [0, -3]}}
  - {name: hex4, start: {position_m: [0, 3]}}
planner: {policy: non_cooperative}
fleet: {assignment: in_order}
mission:
  - take_off
  - formation: {name: cross, points: [[3, 0], [-3, 0], [0, 3], [0, -3]], seconds: 0.5}
  - land
)" + more;
}

class ShieldedProcesses : public FlightLab {
 protected:
  // Flies to its end and reads the log.
  logs::Metrics fly(const std::string& yaml, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"--no-report"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    finish(startFlight(write("shielded.yaml", yaml), arguments));
    return metricsOfLog();
  }
  logs::Metrics metricsOfLog() const {
    return logs::computeMetrics(logs::readFlight((out() / "flight.lcm").string()));
  }
};

int interventions(const logs::Metrics& metrics) {
  int sum = 0;
  for (const logs::VehicleMetrics& vehicle : metrics.vehicles) {
    sum += vehicle.shield.interventions;
  }
  return sum;
}

TEST_F(ShieldedProcesses, CrossInTheMiddleAndTheLogSaysWhoInterfered) {
  const logs::Metrics metrics = fly(fourCross());
  EXPECT_TRUE(metrics.success) << testing::PrintToString(metrics.failures);
  EXPECT_GT(metrics.separation.body_gap.gap_m, 0.0);
  EXPECT_GT(interventions(metrics), 0);
  for (const logs::VehicleMetrics& vehicle : metrics.vehicles) {
    EXPECT_GT(vehicle.shield.steps, 50) << vehicle.name;
    int by_layer = 0;
    for (const auto& [layer, count] : vehicle.shield.by_layer) {
      by_layer += count;
    }
    EXPECT_EQ(by_layer, vehicle.shield.interventions) << "no status is missing in the log";
  }
}

TEST_F(ShieldedProcesses, TouchWithoutIt) {
  const logs::Metrics metrics = fly(fourCross(), {"--shield", "off"});
  EXPECT_FALSE(metrics.success);
  EXPECT_LT(metrics.separation.body_gap.gap_m, 0.0);
  EXPECT_EQ(interventions(metrics), 0);
}

TEST_F(ShieldedProcesses, StayApartWhenPushed) {
  std::string pushes = "sim:\n  pushes:\n";
  for (int i = 0; i < 12; ++i) {
    pushes += "    - {vehicle: hex" + std::to_string(1 + i % 4) +
              ", at_s: " + std::to_string(4.5 + 0.5 * i) +
              ", duration_s: 0.1, acceleration_mps2: [" + (i % 2 == 0 ? "2.5, 0" : "0, -2.5") +
              "]}\n";
  }
  const logs::Metrics metrics = fly(fourCross(pushes));
  EXPECT_TRUE(metrics.success) << testing::PrintToString(metrics.failures);
  EXPECT_GT(metrics.separation.body_gap.gap_m, 0.0);
}

TEST_F(ShieldedProcesses, StayApartWhenTrackingIsLost) {
  const logs::Metrics metrics =
      fly(fourCross("sim: {mocap: {dropout: {probability_per_s: 0.3, duration_s: 0.1}}}\n"));
  EXPECT_TRUE(metrics.separation.touches.empty());
  EXPECT_GT(metrics.separation.body_gap.gap_m, 0.0);
}

TEST_F(ShieldedProcesses, KeepOffABoxAndANoFlyZoneThatTheirPolicyDoesNotKnow) {
  const logs::Metrics metrics = fly(R"(name: box
room: {min_m: [-6, -6, 0], max_m: [6, 6, 3]}
obstacles:
  - {name: box, points_m: [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]}
no_fly_zones:
  - {name: stage, points_m: [[-6, 1.5], [6, 1.5], [6, 6], [-6, 6]]}
vehicle_defaults: {preferred_speed_mps: 1.0}
vehicles:
  - {name: hex1, start: {position_m: [-3, 0]}}
planner: {policy: non_cooperative}
mission:
  - take_off
  - formation: {name: across, points: [[3, 0.1]], seconds: 0.5}
  - land
)");
  EXPECT_TRUE(metrics.success) << testing::PrintToString(metrics.failures);
  EXPECT_TRUE(metrics.obstacles.touches.empty());
  const logs::Flight flight = logs::readFlight((out() / "flight.lcm").string());
  for (const logs::Sample& sample : flight.vehicles.at(0).samples) {
    ASSERT_LT(sample.position_world_m.y(), 1.5 - 0.35) << "no-fly zone";
  }
}

TEST_F(ShieldedProcesses, ARingOfParkedVehiclesOpens) {
  const logs::Metrics metrics = fly(R"(name: ring
room: {min_m: [-6, -6, 0], max_m: [6, 6, 3]}
vehicle_defaults: {preferred_speed_mps: 1.0}
vehicles:
  - {name: hex1, start: {position_m: [1.15, 0]}}
  - {name: hex2, start: {position_m: [0.575, 0.996]}}
  - {name: hex3, start: {position_m: [-0.575, 0.996]}}
  - {name: hex4, start: {position_m: [-1.15, 0]}}
  - {name: hex5, start: {position_m: [-0.575, -0.996]}}
  - {name: hex6, start: {position_m: [0.575, -0.996]}}
  - {name: hex7, start: {position_m: [4, 0.3]}}
planner: {policy: non_cooperative}
fleet: {assignment: in_order}
mission:
  - take_off
  - formation:
      name: ring
      points: [[1.15, 0], [0.575, 0.996], [-0.575, 0.996], [-1.15, 0], [-0.575, -0.996],
               [0.575, -0.996], [0, 0]]
      seconds: 0.5
  - land
)");
  EXPECT_TRUE(metrics.success) << testing::PrintToString(metrics.failures);
  EXPECT_GT(metrics.separation.body_gap.gap_m, 0.0);
}

TEST_F(ShieldedProcesses, FlyRoundAVehicleWhosePlannerWasKilled) {
  cli::ChildProcess& flight =
      startFlight(write("shielded.yaml", fourCross("sim: {pacing: real_time}\n")), {"--no-report"});
  waitUntil("the crossing",
            [this] { return heard().fleet.phase == roundabout_msgs::fleet_status_t::GO; });
  listenFor(std::chrono::milliseconds(1200));
  killProcess({"planner", "hex2"});
  const auto arrived = [this](std::size_t vehicle) {
    return heard().fleet.vehicles.at(vehicle).at_goal;
  };
  waitUntil("the others at their goals", [&] { return arrived(0) && arrived(2) && arrived(3); });
  flight.signal(SIGINT);
  finish(flight);
  const logs::Metrics metrics = metricsOfLog();
  EXPECT_TRUE(metrics.separation.touches.empty());
  EXPECT_GT(metrics.separation.body_gap.gap_m, 0.0);
}

}  // namespace
}  // namespace roundabout::test
