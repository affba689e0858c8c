// What takes a network, or flies in real time.

#include <algorithm>
#include <chrono>
#include <csignal>

#include <gmock/gmock.h>

#include "tests/support/npm.h"
#include "tests/system/mocap_lab.h"

namespace roundabout::test {
namespace {

// Publishers that stand still for a while.
class SilentLab : public MocapLab {
 protected:
  using Messages = std::vector<roundabout_msgs::vehicle_states_t>;

  Messages messagesThroughSilenceOf(cli::ChildProcess& process) {
    Messages messages;
    bus::LcmBus bus(url());
    bus::subscribe<roundabout_msgs::vehicle_states_t>(
        bus, bus::kStatesChannel,
        [&](const roundabout_msgs::vehicle_states_t& message) { messages.push_back(message); },
        [](const bus::DecodeError&) {});
    const auto listen = [&](int milliseconds) {
      const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds);
      while (std::chrono::steady_clock::now() < until) {
        bus.handle(std::chrono::milliseconds(10));
      }
    };
    listen(500);
    process.signal(SIGSTOP);
    listen(200);  // what is under way
    const std::size_t before = messages.size();
    listen(3500);
    EXPECT_EQ(messages.size(), before) << "nothing is said of what nobody sees";
    process.signal(SIGCONT);
    listen(2000);
    EXPECT_GT(messages.size(), before + 150);
    return messages;
  }

  static void expectConventions(const Messages& messages) {
    ASSERT_FALSE(messages.empty());
    for (std::size_t i = 1; i < messages.size(); ++i) {
      const auto& message = messages[i];
      const auto& before = messages[i - 1];
      EXPECT_GT(message.utime, before.utime);
      EXPECT_GT(message.frame_number, before.frame_number);
      // A frame that was lost is missing in the numbers.
      EXPECT_NEAR(static_cast<double>(message.frame_number - before.frame_number),
                  static_cast<double>(message.utime - before.utime) / 5000.0, 1.5);
      for (const auto& state : message.vehicles) {
        EXPECT_EQ(state.last_seen == message.utime, state.tracked != 0);
        EXPECT_FALSE(state.tracked != 0 && state.predicted != 0);
      }
    }
    const auto now = std::chrono::duration_cast<std::chrono::microseconds>(
        std::chrono::system_clock::now().time_since_epoch());
    EXPECT_NEAR(static_cast<double>(messages.back().utime), static_cast<double>(now.count()), 1e6);
    for (const auto& state : messages.back().vehicles) {
      EXPECT_TRUE(state.tracked) << state.name;
    }
  }
};

TEST_F(MocapLab, TheDoctorSaysWhatIsWrongWithBodiesAndUnits) {
  startEmulator("natnet", {"--bodies", "2"});
  const auto examine = [&](const std::string& more) {
    const Ended ended =
        run("roundabout", {"doctor", twoSwap(labFile("natnet", more)), "--lcm-url", url()});
    return testing::PrintToString(ended.lines);
  };
  EXPECT_THAT(examine(""), testing::HasSubstr("every vehicle's is streamed and believed"));
  EXPECT_THAT(examine(", bodies: [{vehicle: hex2, id: 1}]"),
              testing::HasSubstr("hex1 and hex2 are mapped to one body, hex1"));
  EXPECT_THAT(examine(", scale: 1000"), testing::HasSubstr("nothing of body hex1"));
  EXPECT_THAT(examine(", scale: 0.001"), testing::HasSubstr("cm apart, nearer than their bodies"));
}

TEST_F(SilentLab, BridgeAndSimulatorFallSilentAndComeBackAlike) {
  auto& sim = start("sim", {"--config", twoSwap("sim: {pacing: real_time}\n"), "--lcm-url", url()});
  waitUntil("the simulator", [&] { return heard().frames > 20; });
  {
    SCOPED_TRACE("simulator");
    expectConventions(messagesThroughSilenceOf(sim));
  }
  sim.signal(SIGTERM);
  finish(sim);

  auto& motive = startEmulator("natnet", {"--bodies", "2"});
  auto& bridge =
      start("mocap_bridge", {"--config", twoSwap(labFile("natnet")), "--lcm-url", url()});
  const int before = heard().frames;
  waitUntil("the bridge", [&] {
    return heard().frames > before + 20 && heard().states.vehicles.at(1).tracked != 0;
  });
  SCOPED_TRACE("bridge");
  expectConventions(messagesThroughSilenceOf(motive));
  const std::vector<std::string> lines = bridge.lastLines(100);
  const auto said = [&](const std::string& words) {
    return std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
      return line.find(words) != std::string::npos;
    });
  };
  EXPECT_EQ(said("has fallen silent"), 1) << testing::PrintToString(lines);
  EXPECT_EQ(said("Motive is back"), 1) << testing::PrintToString(lines);
}

TEST_F(MocapLab, FliesThroughAnEmulatedMotive) {
  auto& flight = startFlight(twoSwap(), {"--mocap", "natnet", "--no-report"});
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 0) << testing::PrintToString(ended.lines);
  EXPECT_TRUE(leftRunning().empty());
}

}  // namespace
}  // namespace roundabout::test
