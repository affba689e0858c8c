// The stock lcm-logplayer feeds a planner what it heard during a flight, the other planners'
// commands too, and it decides the same again.

#include <gtest/gtest.h>

#include "common/bus/messages.h"
#include "tests/system/flight_lab.h"
#include "tests/system/two_lanes.h"

namespace roundabout::test {
namespace {

class Replay : public FlightLab {
 protected:
  // Commands of a planner that is started by hand and hears the log.
  std::vector<std::string> replayed(const std::string& vehicle) {
    std::vector<std::string> commands;
    bus().subscribe(bus::commandChannel(vehicle), [&commands](const bus::Received& received) {
      commands.emplace_back(reinterpret_cast<const char*>(received.payload.data()),
                            received.payload.size());
    });
    cli::ChildProcess& planner =
        start("planner", {"--config", (out() / "experiment.yaml").string(), "--vehicle", vehicle,
                          "--lcm-url", url(), "--set", "planner.watch_wall_clock=false"});
    waitUntil("the planner",
              [&] { return modeOf(vehicle) == roundabout_msgs::planner_status_t::WAITING; });
    run("lcm-logplayer", {"--speed=2",
                          "--regexp=VEHICLE_STATES|SAFETY_ORDER|GOAL_" + vehicle + "|LASER_SCAN_" +
                              vehicle + "|COMMAND_hex[^" + vehicle.back() + "]",
                          "--lcm-url=" + url(), (out() / "flight.lcm").string()});
    listenFor(std::chrono::milliseconds(200));
    planner.signal(SIGTERM);
    finish(planner);
    return commands;
  }

  void expectTheSame(const std::string& vehicle) {
    const auto recorded = payloadsOf(out() / "flight.lcm").at(bus::commandChannel(vehicle));
    const auto again = replayed(vehicle);
    ASSERT_GT(recorded.size(), 50u);
    ASSERT_EQ(again.size(), recorded.size());
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      ASSERT_EQ(again[i], recorded[i]) << "command " << i;
    }
  }
};

TEST_F(Replay, OfALockstepFlightGivesTheRecordedCommands) {
  ASSERT_TRUE(finish(startFlight(twoSwap(), {"--no-report"})).status.clean());
  expectTheSame("hex1");
}

TEST_F(Replay, OfARealTimeFlightGivesTheRecordedCommands) {
  ASSERT_TRUE(finish(startFlight(twoSwap(), {"--real-time", "--no-report"})).status.clean());
  expectTheSame("hex2");
}

TEST_F(Replay, OfAFlightByScansGivesTheRecordedCommands) {
  const std::string file =
      write("two_lanes.yaml", twoLanes(scratch_.path(), ", lidar: {noise_m: 0.02}"));
  ASSERT_TRUE(finish(startFlight(file, {"--no-report"})).status.clean());
  expectTheSame("hex2");
}

}  // namespace
}  // namespace roundabout::test
