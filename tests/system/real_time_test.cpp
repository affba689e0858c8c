// A flight at the pace of the wall clock keeps it.

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

class RealTime : public FlightLab {};

TEST_F(RealTime, ASwapArrivesUntouchedOnFramesThatKeepTheirRate) {
  const Ended flight = finish(startFlight(twoSwap(), {"--real-time"}));
  EXPECT_TRUE(flight.status.clean()) << flight.status.describe();
  std::ifstream file(out() / "metrics.json");
  const auto metrics = nlohmann::json::parse(file);
  EXPECT_TRUE(metrics["success"]);
  ASSERT_EQ(metrics["formations"].size(), 1u);
  for (const auto& vehicle : metrics["formations"][0]["vehicles"]) {
    EXPECT_TRUE(vehicle["reached"]) << vehicle;
  }
  EXPECT_EQ(metrics["separation"]["body_touches"]["count"], 0);
  EXPECT_TRUE(metrics["separation"]["unseen"].empty());
  EXPECT_TRUE(metrics["timing"]["real_time"]);
  EXPECT_EQ(metrics["timing"]["missing_frames"], 0);
  EXPECT_NEAR(metrics["timing"]["rate_hz"], 200.0, 0.5);
}

}  // namespace
}  // namespace roundabout::test
