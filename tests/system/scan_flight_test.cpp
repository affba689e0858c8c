// Flights with the policies that the paper compares with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/nn/safetensors.h"
#include "tests/support/drl_maca_weights.h"
#include "tests/support/reference.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

class ScanFlight : public FlightLab {
 protected:
  // Two vehicles in lanes of their own, since the network does not avoid anybody.
  std::string twoLanes(const std::string& defaults) const {
    const std::string weights = scratch_ / "drl_maca.safetensors";
    planner::nn::writeSafetensors(weights, goalSeekingDrlMaca());
    return write("two_lanes.yaml",
                 "room: {min_m: [-5, -5, 0], max_m: [5, 5, 3]}\n"
                 "vehicle_defaults: {preferred_speed_mps: 1.0" +
                     defaults +
                     "}\n"
                     "vehicles:\n"
                     "  - {name: hex1, start: {position_m: [-2, -2]}}\n"
                     "  - {name: hex2, start: {position_m: [-2, 2]}}\n"
                     "planner: {policy: \"drl_maca:" +
                     weights +
                     "\"}\n"
                     "fleet: {assignment: in_order}\n"
                     "mission:\n"
                     "  - take_off\n"
                     "  - formation: {name: ahead, points: [[2, -2], [2, 2]]}\n"
                     "  - land\n");
  }
};

TEST_F(ScanFlight, ByTheSimulatorsLidarArrivesAndRepeatsByteForByte) {
  const std::string file = twoLanes(", lidar: {noise_m: 0.02, sees_room_walls: true}");
  const Ended flight = finish(startFlight(file, {"--no-report"}));
  EXPECT_THAT(flight.lines, Contains(HasSubstr("1 of 1 formations formed, no bodies touched")));
  const auto first = payloadsOf(out() / "flight.lcm");
  std::filesystem::rename(out(), scratch_ / "first");
  finish(startFlight(file, {"--no-report"}));
  const auto second = payloadsOf(out() / "flight.lcm");
  for (const char* channel :
       {"VEHICLE_STATES", "COMMAND_hex1", "COMMAND_hex2", "LASER_SCAN_hex1", "LASER_SCAN_hex2"}) {
    ASSERT_FALSE(first.at(channel).empty()) << channel;
    EXPECT_TRUE(first.at(channel) == second.at(channel)) << channel << " differs";
  }
}

TEST_F(ScanFlight, DoesNotBeginWithoutALidar) {
  const Ended flight = finish(startFlight(twoLanes(""), {"--no-report"}));
  EXPECT_FALSE(flight.status.clean());
  EXPECT_THAT(flight.lines, Contains(HasSubstr("vehicles[0].lidar: expected one, since the policy "
                                               "drl_maca flies by it, found none")));
}

TEST_F(FlightLab, TwoSwapPlacesWithThePublishedSaCadrl) {
  const std::string network =
      referenceFolder() / "cadrl" / "no_constr_none_4_agents_policy_iter_1000.safetensors";
  if (!std::filesystem::exists(network)) {
    GTEST_SKIP() << "the published network is not at " << network;
  }
  const Ended flight = finish(
      startFlight(twoSwap("planner: {policy: \"cadrl:" + network + "\"}\n"), {"--no-report"}));
  EXPECT_THAT(flight.lines, Contains(HasSubstr("1 of 1 formations formed, no bodies touched")));
}

}  // namespace
}  // namespace roundabout::test
