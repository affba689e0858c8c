// A ground robot among people, every process real.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class PedestrianFlight : public FlightLab {
 protected:
  // The rest of the vehicle follows.
  static std::string rover() {
    return R"(
room: {min_m: [-5, -5, 0], max_m: [5, 5, 3]}
vehicles:
  - name: rover
    model: ground_robot
    preferred_speed_mps: 1.2
    assumed_radius_m: 0.3
    body_radius_m: 0.25
    height_m: 0.3
)";
  }

  // Two people stand beside the way of a robot that sees by its lidar alone.
  std::string crossing() const {
    return write("crossing.yaml", R"(
name: crossing)" + rover() + R"(    start: {position_m: [-3, 0]}
    localised_by: odometry
    lidar: {beams: 720, field_of_view_rad: 6.2744, max_range_m: 10, noise_m: 0.01, sweep_s: 0.025}
pedestrians:
  count: 2
  standing_share: 1
  area: {min_m: [-1, -1.5], max_m: [1, 1.5]}
planner: {policy: orca, others: tracks}
perception: {detector: none, map_rate_hz: 2}
mission:
  - take_off
  - formation: {name: across, points: [[3, 0]]}
  - land
)");
  }
};

TEST_F(PedestrianFlight, TheRobotSeesPeopleGoesRoundThemAndRepeats) {
  const Ended flight = finish(startFlight(crossing(), {"--no-report"}));
  EXPECT_THAT(flight.lines, Contains(HasSubstr("1 of 1 formations formed, no bodies touched")));
  EXPECT_THAT(flight.lines, Contains(HasSubstr("closest person")));
  const auto first = payloadsOf(out() / "flight.lcm");
  for (const char* channel : {"LASER_SCAN_rover", "ODOMETRY_rover", "AGENT_TRACKS_rover",
                              "PEDESTRIAN_TRUTH", "OCCUPANCY_rover"}) {
    EXPECT_TRUE(first.contains(channel)) << channel;
  }
  std::filesystem::rename(out(), scratch_ / "first");
  finish(startFlight(crossing(), {"--no-report"}));
  const auto second = payloadsOf(out() / "flight.lcm");
  EXPECT_TRUE(first.at("VEHICLE_STATES") == second.at("VEHICLE_STATES"));
  EXPECT_TRUE(first.at("COMMAND_rover") == second.at("COMMAND_rover"));
}

TEST_F(PedestrianFlight, TheRobotGoesRoundWhatOnlyItsDepthCameraSees) {
  const auto fly = [this](const std::string& cameras) {
    const std::string file = write("low_box.yaml", R"(
name: low_box)" + rover() + R"(    start: {position_m: [-2.4, 0]}
    lidar: {beams: 720, field_of_view_rad: 6.2744, max_range_m: 10, noise_m: 0.01, sweep_s: 0.025}
)" + cameras + R"(
planner: {policy: orca, others: tracks}
perception: {detector: none, map_rate_hz: 5}
fleet: {hold_s: 0.2}
sim:
  clutter: [{name: box, points_m: [[0, -0.4], [0.4, -0.4], [0.4, 0.4], [0, 0.4]], top_m: 0.15}]
mission: [take_off, {formation: {name: across, points: [[1.6, 0]]}}]
)");
    std::filesystem::remove_all(out());
    return finish(startFlight(file, {"--no-report"}));
  };
  // Without it the robot drives into the box, which is lower than the lidar.
  EXPECT_THAT(fly("").lines, Contains(HasSubstr("rover touched obstacle box")));
  const Ended seen =
      fly("    cameras: [{name: front, width: 160, height: 120, "
          "depth: {noise_per_m: 0.0025, missed_share: 0.05}}]");
  EXPECT_THAT(seen.lines, Contains(HasSubstr("1 of 1 formations formed, no bodies touched")));
  EXPECT_THAT(seen.lines, Not(Contains(HasSubstr("touched obstacle"))));
}

TEST_F(PedestrianFlight, TheRobotStopsWhenItsPerceptionIsGone) {
  cli::ChildProcess& flight = startFlight(crossing(), {"--no-report", "--real-time"});
  waitUntil("the robot drives", [this] {
    return heard().planners.contains("rover") &&
           modeOf("rover") == roundabout_msgs::planner_status_t::FLYING;
  });
  killProcess({"perception"});
  waitUntil("the robot holds",
            [this] { return modeOf("rover") == roundabout_msgs::planner_status_t::HOLDING; });
  EXPECT_EQ(heard().planners.at("rover").reason, "no tracks from perception");
  EXPECT_GT(heard().planners.at("rover").ticks_without_tracks, 0);
  flight.signal(SIGINT);
  const Ended ended = finish(flight);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("its vehicle holds: it sees nobody")));
}

}  // namespace
}  // namespace roundabout::test
