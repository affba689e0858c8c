// Flights with the policies that the paper compares with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/reference.h"
#include "tests/system/flight_lab.h"
#include "tests/system/two_lanes.h"

namespace roundabout::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

class ScanFlight : public FlightLab {
 protected:
  std::string lanes(const std::string& defaults) const {
    return write("two_lanes.yaml", twoLanes(scratch_.path(), defaults));
  }
};

TEST_F(ScanFlight, ByTheSimulatorsLidarArrivesAndRepeatsByteForByte) {
  const std::string file = lanes(", lidar: {noise_m: 0.02, sees_room_walls: true}");
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
  const Ended flight = finish(startFlight(lanes(""), {"--no-report"}));
  EXPECT_FALSE(flight.status.clean());
  EXPECT_THAT(flight.lines, Contains(HasSubstr("].lidar: expected one, since the policy "
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
