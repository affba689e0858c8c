// Scripts in Python and Lua fly a real simulated fleet; what goes wrong reaches them as what it is.

#include <csignal>

#include <gmock/gmock.h>

#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using roundabout_msgs::fleet_status_t;
using testing::Contains;
using testing::HasSubstr;

class Script : public FlightLab {
 protected:
  cli::ChildProcess& startFleet(const std::vector<std::string>& arguments = {"--no-report"}) {
    cli::ChildProcess& flight = startFlight(write("scripted.yaml", R"(name: scripted
seed: 3
room: {min_m: [-8, -8, 0], max_m: [8, 9, 3]}
vehicle_defaults: {preferred_speed_mps: 1.0}
vehicles:
  - {name: hex1, start: {position_m: [0, 0]}}
  - {name: hex2, start: {position_m: [-2, 0]}}
  - {name: hex3, start: {position_m: [-4, 0]}}
fleet: {assignment: in_order, hold_s: 0.2}
)"),
                                            arguments);
    const int before = heard().fleet_statuses;
    waitUntil("an idle fleet", [&] {
      return heard().fleet_statuses > before && heard().fleet.phase == fleet_status_t::IDLE;
    });
    return flight;
  }

  cli::ChildProcess& startScript(const std::string& file, std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), {"script", file});
    arguments.insert(arguments.end(), {"--lcm-url", url()});
    return start("roundabout", arguments);
  }

  /// Each in a flight of its own, from the same places.
  void flyExample(const std::string& language, const std::string& name, const std::string& argument,
                  const std::string& says) {
    SCOPED_TRACE(language + " " + name);
    cli::ChildProcess& flight = startFleet();
    const std::string file = std::string(ROUNDABOUT_SOURCE_DIR) + "/fleet/scripting/" + language +
                             "/examples/" + name + (language == "python" ? ".py" : ".lua");
    const Ended ended = finish(startScript(file, {argument}));
    EXPECT_TRUE(ended.status.clean());
    EXPECT_THAT(ended.lines, Contains(HasSubstr(says)));
    EXPECT_LT(heightOf("hex1"), 0.2);
    flight.signal(SIGINT);
    finish(flight);
    std::filesystem::remove_all(out());
  }

  void flyTheExamples(const std::string& language) {
    flyExample(language, "spell", "HI", "I is formed");
    flyExample(language, "rotating_circle", "3", "turned by 60 degrees");
    flyExample(language, "follow_leader", "3", "hex1 leads at (2.6, 1.");
  }

  std::string python(const std::string& body) const {
    return write("script.py", "from roundabout import *\n" + body);
  }
};

TEST_F(Script, InPythonSpellsTurnsAndFollows) { flyTheExamples("python"); }

TEST_F(Script, InLuaSpellsTurnsAndFollows) {
  if (std::system("lua5.2 -e 'require(\"lcm\")' >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "no Lua with LCM (Debian packages lua5.2 and liblcm-lua)";
  }
  flyTheExamples("lua");
}

TEST_F(Script, IsToldWhyItIsRefused) {
  cli::ChildProcess& flight = startFleet();
  const Ended ended = finish(startScript(python(R"(
fleet = Fleet()
try:
    fleet.go_to("hex1", (1, 1, 1))
except Refused as refused:
    print("first:", refused)
fleet.take_off()
try:
    fleet.formation([(0, 0, 1), (2, 2, 1), (2.4, 2, 1)])
except Refused as refused:
    print("second:", refused)
first = fleet.formation([(0, 0, 1), (2, 2, 1), (4, 2, 1)], wait=False)
fleet.hold()
try:
    fleet.wait_until_done(first)
except Refused as refused:
    print("third:", refused)
fleet.formation([(0, 0, 1), (2, 2, 1), (4, 2, 1)], seconds=1, wait=False)
fleet.wait_until_formed()
print("formed in phase", fleet.phase, round(fleet.states()["hex2"].position[0], 1))
fleet.wait_until("go_on", wait=False)
while fleet.status.reason != "waits for go_on":
    fleet.states()
fleet.go_on()
fleet.wait_until_done()
fleet.wait_until("formed")
print("went on")
fleet.land()
)")));
  EXPECT_TRUE(ended.status.clean());
  EXPECT_THAT(ended.lines, Contains("first: all vehicles are on the floor: take off first"));
  EXPECT_THAT(ended.lines, Contains(testing::AllOf(HasSubstr("second: goals 2 and 3 are 0.40 m"),
                                                   HasSubstr("must be 1.10"))));
  EXPECT_THAT(ended.lines, Contains("third: dropped by hold"));
  EXPECT_THAT(ended.lines, Contains(HasSubstr("formed in phase hold")));
  EXPECT_THAT(ended.lines, Contains("went on"));
  flight.signal(SIGINT);
  finish(flight);
}

TEST_F(Script, SaysWhenTheFleetDies) {
  cli::ChildProcess& flight = startFleet();
  cli::ChildProcess& script = startScript(python(R"(
fleet = Fleet()
fleet.take_off()
print("in the air", flush=True)
fleet.wait(1000)
)"));
  waitUntil("take-off", [&] {
    const auto lines = script.lastLines(10);
    return std::find(lines.begin(), lines.end(), "in the air") != lines.end();
  });
  killProcess({"fleet"});
  const Ended ended = finish(script);
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines,
              Contains(testing::AnyOf(HasSubstr("FleetLost: the fleet has said nothing"),
                                      HasSubstr("FleetForgot"))));
  EXPECT_GT(heightOf("hex1"), 0.8) << "it stays at its goal";
  flight.signal(SIGINT);
  finish(flight);
}

TEST_F(Script, ThatIsKilledLeavesTheVehiclesAtTheirGoals) {
  cli::ChildProcess& flight = startFleet();
  cli::ChildProcess& script = startScript(python(R"(
fleet = Fleet()
fleet.take_off()
fleet.formation([(0, 2, 1), (2, 2, 1), (4, 2, 1)], wait=False)
print("under way", flush=True)
fleet.wait(1000)
)"));
  waitUntil("the way", [&] {
    const auto lines = script.lastLines(10);
    return std::find(lines.begin(), lines.end(), "under way") != lines.end();
  });
  script.signal(SIGKILL);
  finish(script);
  waitUntil("the formation", [&] { return heard().fleet.vehicles_at_goal == 3; });
  EXPECT_NE(heard().fleet.phase, int{fleet_status_t::FAILED});
  EXPECT_GT(heightOf("hex1"), 0.8);
  // Another one takes over.
  EXPECT_TRUE(finish(startScript(python("Fleet().land()\n"))).status.clean());
  EXPECT_LT(heightOf("hex1"), 0.2);
  flight.signal(SIGINT);
  finish(flight);
}

TEST_F(Script, WithoutAFleetEndsAndSaysSo) {
  const Ended ended = finish(startScript(python("Fleet()\n")));
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("FleetLost: no fleet is heard")));
}

TEST_F(Script, MissionFilesAreSentStepByStep) {
  cli::ChildProcess& flight = startFleet();
  const std::string file = write("mission.yaml", R"(mission:
  - take_off
  - repeat:
      times: 2
      steps:
        - formation: {name: near, points: [[0, 2, 1], [2, 2, 1], [4, 2, 1]], seconds: 0.2}
        - go_to: {vehicle: hex1, point: [0, 0, 1]}
  - wait_until: go_on
  - land
)");
  cli::ChildProcess& sender =
      start("roundabout", {"mission", "send", file, "--follow", "--lcm-url", url()});
  waitUntil("the word", [&] { return heard().fleet.reason == "waits for go_on"; });
  EXPECT_TRUE(run("roundabout", {"mission", "go_on", "--lcm-url", url()}).status.clean());
  const Ended sent = finish(sender);
  EXPECT_TRUE(sent.status.clean());
  EXPECT_THAT(sent.lines, Contains(HasSubstr("go near")));
  EXPECT_LT(heightOf("hex1"), 0.2);
  EXPECT_EQ(run("roundabout", {"mission", "status", "--lcm-url", url()}).status.code, 0);
  const std::string wrong = write("wrong.yaml", "mission: [{spell: HI}, {dance: 1}]\n");
  const Ended refused = run("roundabout", {"mission", "send", wrong, "--lcm-url", url()});
  EXPECT_EQ(refused.status.code, 2);
  EXPECT_THAT(refused.lines, Contains(HasSubstr("wrong.yaml:1: mission[1]")));
  flight.signal(SIGINT);
  finish(flight);
}

}  // namespace
}  // namespace roundabout::test
