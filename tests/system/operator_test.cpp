// What an operator types while something flies: orders, missions, and the front script.

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using roundabout_msgs::fleet_status_t;
using roundabout_msgs::planner_status_t;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class Operator : public FlightLab {
 protected:
  Ended type(std::vector<std::string> words) {
    words.insert(words.end(), {"--lcm-url", url()});
    return run("roundabout", words);
  }

  // Without a mission in its file: it is steered by what is typed.
  cli::ChildProcess& startWithoutMission() {
    cli::ChildProcess& flight =
        startFlight(write("steered.yaml",
                          "name: steered\nseed: 3\n"
                          "vehicles:\n"
                          "  - {name: hex1, start: {position_m: [-1.5, 0]}}\n"
                          "  - {name: hex2, start: {position_m: [1.5, 0]}}\n"
                          "fleet: {hold_s: 0.1}\n"),
                    {"--no-report"});
    waitUntil("an idle fleet", [this] { return heard().fleet.phase == fleet_status_t::IDLE; });
    return flight;
  }
};

TEST_F(Operator, IsToldWhoObeyedAnOrder) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
  waitUntil("take-off", [this] { return heightOf("hex1") > 0.3 && heightOf("hex2") > 0.3; });
  const Ended hold = type({"order", "hold"});
  EXPECT_TRUE(hold.status.clean());
  EXPECT_THAT(hold.lines,
              ElementsAre("hex1: holding, ordered to hold", "hex2: holding, ordered to hold"));
  const Ended kill = type({"order", "kill", "--vehicle", "hex2"});
  EXPECT_TRUE(kill.status.clean());
  EXPECT_THAT(kill.lines, ElementsAre(HasSubstr("hex2: killed")));
  flight.signal(SIGINT);
  finish(flight);
}

TEST_F(Operator, IsToldThatTheVehicleOfAnOrderDoesNotExist) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
  waitUntil("planners", [this] { return modeOf("hex1") >= 0 && modeOf("hex2") >= 0; });
  const Ended order = type({"order", "kill", "--vehicle", "hxe2"});
  EXPECT_EQ(order.status.code, 1);
  EXPECT_THAT(order.lines, ElementsAre(HasSubstr("no vehicle hxe2 (heard: hex1, hex2)")));
  flight.signal(SIGINT);
  finish(flight);
}

TEST_F(Operator, IsToldThatNobodyHearsAnOrder) {
  const Ended order = type({"order", "land"});
  EXPECT_EQ(order.status.code, 1);
  EXPECT_THAT(order.lines, ElementsAre(AllOf(HasSubstr("no planner answered"), HasSubstr(url()))));
}

TEST_F(Operator, KillsAPlannerThatHasNoStates) {
  start("planner", {"--config", twoSwap("sim: {pacing: real_time}\n"), "--vehicle", "hex1",
                    "--lcm-url", url()});
  waitUntil("the planner", [this] { return modeOf("hex1") == planner_status_t::WAITING; });
  const Ended kill = type({"order", "kill"});
  EXPECT_TRUE(kill.status.clean());
  EXPECT_THAT(kill.lines, ElementsAre(HasSubstr("hex1: killed")));
}

TEST_F(Operator, FliesWhatIsTypedUntilCtrlC) {
  cli::ChildProcess& flight = startWithoutMission();
  EXPECT_TRUE(type({"mission", "take_off"}).status.clean());
  EXPECT_TRUE(type({"mission", "spell", "II"}).status.clean());
  waitUntil("the letter", [this] { return heard().fleet.formation == "I"; });
  waitUntil("the last letter", [this] { return heard().fleet.phase == fleet_status_t::IDLE; });
  EXPECT_GT(heightOf("hex1"), 0.8) << "landed although nobody said so";
  flight.signal(SIGINT);
  EXPECT_EQ(finish(flight).status.code, 130);
}

TEST_F(Operator, IsToldWhyAMissionIsRefused) {
  cli::ChildProcess& flight = startWithoutMission();
  const Ended mission = type({"mission", "spell", "II"});
  EXPECT_EQ(mission.status.code, 1);
  EXPECT_THAT(mission.lines, ElementsAre(AllOf(HasSubstr("refused"), HasSubstr("take off first"))));
  flight.signal(SIGINT);
  finish(flight);
}

TEST_F(Operator, IsToldThatNoFleetHearsAMission) {
  const Ended mission = type({"mission", "land"});
  EXPECT_EQ(mission.status.code, 1);
  EXPECT_THAT(mission.lines, ElementsAre(HasSubstr("no fleet is heard")));
}

TEST_F(Operator, DoesNotWaitForABuildToSendAnOrder) {
  const std::filesystem::path tree = scratch_ / "tree";
  std::filesystem::create_directories(tree / "build/release/bin");
  std::filesystem::copy(ROUNDABOUT_SOURCE_DIR "/roundabout", tree / "roundabout");
  const std::filesystem::path built = tree / "build/release/bin/roundabout";
  std::ofstream(built) << "#!/bin/sh\necho \"$@\"\n";
  std::filesystem::permissions(built, std::filesystem::perms::owner_all);
  // There is nothing to build here: whoever tries fails.
  const Ended order = run((tree / "roundabout").string(), {"order", "kill", "--vehicle", "hex1"});
  EXPECT_TRUE(order.status.clean());
  EXPECT_THAT(order.lines, ElementsAre("order kill --vehicle hex1"));
  EXPECT_THAT(run((tree / "roundabout").string(), {"mission", "land"}).lines,
              ElementsAre("mission land"));
}

}  // namespace
}  // namespace roundabout::test
