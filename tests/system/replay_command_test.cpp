// `roundabout replay`: what it plays arrives whole, and a planner that hears a log decides as
// recorded.

#include <gmock/gmock.h>

#include "common/bus/messages.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ReplayCommand : public FlightLab {
 protected:
  void SetUp() override {
    ASSERT_TRUE(finish(startFlight(twoSwap(), {"--no-report"})).status.clean());
    recorded_ = payloadsOf(log());
  }

  std::string log() const { return (out() / "flight.lcm").string(); }

  Ended replay(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"replay", log()});
    return run("roundabout", arguments);
  }

  std::map<std::string, std::vector<std::string>> recorded_;
};

TEST_F(ReplayCommand, PlaysEveryMessageToAListener) {
  std::map<std::string, std::vector<std::string>> heard;
  bus().subscribePrefix("", [&](const bus::Received& received) {
    heard[std::string(received.channel)].emplace_back(
        reinterpret_cast<const char*>(received.payload.data()), received.payload.size());
  });
  // Faster than anybody can listen: it goes as fast as they can.
  const Ended ended = replay({"--speed", "1000", "--lcm-url", url(), "--without",
                              "COMMAND_hex2|LCM_SELF_TEST", "--rename", "COMMAND_hex1=SHADOW"});
  EXPECT_TRUE(ended.status.clean());
  listenFor(std::chrono::milliseconds(200));
  heard.erase("LCM_SELF_TEST");
  recorded_.erase("LCM_SELF_TEST");
  recorded_.erase("COMMAND_hex2");
  recorded_["SHADOW"] = recorded_.at("COMMAND_hex1");
  recorded_.erase("COMMAND_hex1");
  EXPECT_EQ(heard, recorded_);
}

TEST_F(ReplayCommand, RefusesToPlayOverAFlight) {
  const auto of_the_flight = heard().frames;
  start("roundabout",
        {"replay", log(), "--from", "0.2", "--speed", "0.1", "--loop", "--lcm-url", url()});
  waitUntil("states", [&] { return heard().frames > of_the_flight + 10; });
  const Ended second = replay({"--lcm-url", url()});
  EXPECT_EQ(second.status.code, 2);
  EXPECT_THAT(second.lines, Contains(HasSubstr("of somebody else")));
}

TEST_F(ReplayCommand, FindsEveryCommandOfAPlannerEqual) {
  for (const std::vector<std::string>& pace :
       {std::vector<std::string>{}, {"--speed", "10"}, {"--speed", "1"}}) {
    std::vector<std::string> arguments{"--check", "planner:hex2"};
    arguments.insert(arguments.end(), pace.begin(), pace.end());
    const Ended ended = replay(arguments);
    EXPECT_TRUE(ended.status.clean());
    const std::string all = std::to_string(recorded_.at("COMMAND_hex2").size());
    EXPECT_THAT(ended.lines,
                Contains(HasSubstr("hex2: " + all + " of " + all + " commands equal")));
  }
}

TEST_F(ReplayCommand, ShowsTheFirstDifferenceOfAnotherPlanner) {
  const Ended ended = replay({"--check", "planner:hex1", "--policy", "static"});
  EXPECT_EQ(ended.status.code, 1);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("first difference: command")));
  EXPECT_THAT(ended.lines, Contains(HasSubstr("recorded: velocity")));
  EXPECT_THAT(ended.lines, Contains(HasSubstr("* hex1")));
}

TEST_F(ReplayCommand, DrawsWhatAnotherPolicyWouldHaveDone) {
  const std::string pictures = (scratch_ / "what_if").string();
  const Ended ended = replay({"--policy", "non_cooperative", "--out", pictures});
  EXPECT_TRUE(ended.status.clean());
  EXPECT_THAT(ended.lines, Contains(HasSubstr("hex2: non_cooperative would have commanded")));
  for (const char* picture : {"hex1.png", "hex1.svg", "hex2.png"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(pictures) / picture)) << picture;
  }
}

TEST_F(ReplayCommand, RefusesWhatItCannotDoInOneLine) {
  EXPECT_THAT(replay({"--check", "fleet"}).lines, Contains(HasSubstr("expected planner:VEHICLE")));
  EXPECT_THAT(replay({"--check", "planner:hex9"}).lines, Contains(HasSubstr("found hex9")));
  EXPECT_THAT(replay({"--rename", "A"}).lines, Contains(HasSubstr("expected OLD=NEW")));
}

}  // namespace
}  // namespace roundabout::test
