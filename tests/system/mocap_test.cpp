// The bridge as a process: emulated systems in front of it, LCM behind it.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "tests/support/npm.h"
#include "tests/support/reference.h"
#include "tests/system/mocap_lab.h"

namespace roundabout::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr std::int64_t kCoast = 100'000;
constexpr std::int64_t kReacquire = 50'000;

// Of a vehicle in two messages, one of which follows the other.
void expectConventionsOfLoss(const roundabout_msgs::vehicle_state_t& before,
                             const roundabout_msgs::vehicle_state_t& state, std::int64_t utime) {
  const std::int64_t age = utime - state.last_seen;
  EXPECT_EQ(state.last_seen == utime, state.tracked != 0);
  EXPECT_EQ(state.predicted != 0, state.tracked == 0 && age <= kCoast) << age;
  if (state.tracked != 0 && before.tracked == 0) {
    const std::int64_t gap = utime - before.last_seen;
    EXPECT_TRUE(gap <= kCoast || gap > kCoast + kReacquire) << gap;
  }
  if (state.tracked == 0 && state.predicted == 0 && before.predicted == 0) {
    EXPECT_TRUE(std::equal(state.position, state.position + 3, before.position));
    EXPECT_TRUE(std::equal(state.velocity, state.velocity + 3, before.velocity));
  }
}

void expectHouseConventions(const std::vector<roundabout_msgs::vehicle_states_t>& messages) {
  ASSERT_GT(messages.size(), 150U);
  std::vector<std::int64_t> intervals;
  int predicted = 0;
  int lost = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto& message = messages[i];
    ASSERT_EQ(message.num_vehicles, 2);
    EXPECT_EQ(message.exposure_utime, message.utime);
    for (int k = 0; k < 2; ++k) {
      const auto& state = message.vehicles[static_cast<std::size_t>(k)];
      EXPECT_EQ(state.name, "hex" + std::to_string(k + 1));
      double norm = 0.0;
      for (const double part : state.orientation) {
        norm += part * part;
      }
      EXPECT_NEAR(norm, 1.0, 1e-9);
      EXPECT_FALSE(state.tracked != 0 && state.predicted != 0);
      predicted += state.predicted != 0 ? 1 : 0;
      lost += state.predicted == 0 && state.tracked == 0 ? 1 : 0;
      if (i > 0 && message.frame_number == messages[i - 1].frame_number + 1) {
        expectConventionsOfLoss(messages[i - 1].vehicles[static_cast<std::size_t>(k)], state,
                                message.utime);
      }
    }
    if (i > 0) {
      EXPECT_GT(message.utime, messages[i - 1].utime);
      EXPECT_GT(message.frame_number, messages[i - 1].frame_number);
      intervals.push_back((message.utime - messages[i - 1].utime) /
                          (message.frame_number - messages[i - 1].frame_number));
    }
  }
  std::nth_element(intervals.begin(),
                   intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2),
                   intervals.end());
  EXPECT_NEAR(static_cast<double>(intervals[intervals.size() / 2]), 5000.0, 50.0);
  EXPECT_GT(predicted, 0);
  EXPECT_GT(lost, 0);
}

TEST_F(MocapLab, BridgeAndSimulatorCannotBeToldApart) {
  // Cameras that lose the vehicles more often than they see them.
  const std::string cameras =
      "sim: {pacing: real_time, mocap: {dropout: {probability_per_s: 8, duration_s: 0.15}}}\n";
  auto& sim = start("sim", {"--config", twoSwap(cameras), "--lcm-url", url()});
  waitUntil("the simulator", [&] { return heard().frames > 20; });
  const Traffic simulated = listen(1.5);
  sim.signal(SIGTERM);
  finish(sim);

  const std::string lab = twoSwap(labFile("natnet") + cameras);
  start("sim", {"--scene", "--config", lab, "--lcm-url", url()});
  startEmulator("natnet", {"--scene", "sim", "--lcm-url", url()});
  start("mocap_bridge", {"--config", lab, "--lcm-url", url()});
  const int before = heard().frames;
  waitUntil("the bridge", [&] {
    return heard().frames > before + 20 && heard().states.vehicles.at(0).last_seen != 0 &&
           heard().states.vehicles.at(1).last_seen != 0;
  });
  Traffic bridged = listen(1.5);
  EXPECT_EQ(bridged.channels.erase(bus::kSceneChannel), 1U) << "what its cameras see";

  EXPECT_EQ(simulated.channels, bridged.channels);
  EXPECT_EQ(simulated.fingerprints, bridged.fingerprints);
  {
    SCOPED_TRACE("simulator");
    expectHouseConventions(simulated.messages);
  }
  SCOPED_TRACE("bridge");
  expectHouseConventions(bridged.messages);
}

TEST_F(MocapLab, SaysThatNobodyAnswersAndGoesOnOnceSomebodyDoes) {
  auto& bridge =
      start("mocap_bridge", {"--config", twoSwap(labFile("natnet")), "--lcm-url", url()});
  waitUntil("a word on the missing server", [&] {
    return testing::Value(bridge.lastLines(5), Contains(HasSubstr("no answer from Motive")));
  });
  startEmulator("natnet", {"--bodies", "1"});
  waitUntil("frames", [&] { return heard().frames > 100; });
  EXPECT_TRUE(heard().states.vehicles.at(0).tracked);
  waitUntil("a word on the missing body", [&] {
    return testing::Value(
        bridge.lastLines(20),
        Contains(HasSubstr("streams no body hex2 (mocap.bodies); it streams hex1")));
  });
}

TEST_F(MocapLab, WrongSettingsEndTheStart) {
  const auto error = [&](const std::string& file) {
    const Ended ended = run("mocap_bridge", {"--config", file, "--lcm-url", url()});
    EXPECT_EQ(ended.status.code, 2);
    return ended.lines.empty() ? "" : ended.lines.back();
  };
  EXPECT_THAT(error(twoSwap()), HasSubstr("source"));
  EXPECT_THAT(error(twoSwap(labFile("natnet", ", axes: 'x,z,y'"))), HasSubstr("mirror image"));
  EXPECT_THAT(error(twoSwap("source: natnet\nmocap: {interface: eth99}\n")),
              HasSubstr("an interface of this machine (lo 127.0.0.1"));
  EXPECT_THAT(error(twoSwap("source: qualisys\n")), HasSubstr("mocap.server"));
  EXPECT_THAT(error(twoSwap("source: replay\nmocap: {file: nowhere.bin}\n")),
              HasSubstr("nowhere.bin"));
}

TEST_F(MocapLab, TheDoctorLooksAtTheMotionCaptureSystem) {
  const auto examine = [&](const std::string& file) {
    const Ended ended = run("roundabout", {"doctor", file, "--lcm-url", url()});
    EXPECT_NE(ended.status.code, 2);
    return testing::PrintToString(ended.lines);
  };
  EXPECT_THAT(examine(twoSwap("source: natnet\nmocap: {interface: eth99}\n")),
              HasSubstr("an interface of this machine (lo 127.0.0.1"));
  const std::string lab = twoSwap(labFile("natnet"));
  EXPECT_THAT(examine(lab), HasSubstr("no answer from Motive"));
  startEmulator("natnet", {"--bodies", "1"});
  const std::string found = examine(lab);
  EXPECT_THAT(found, HasSubstr("frames a second"));
  EXPECT_THAT(found, HasSubstr("hex2: the system streams no body hex2 (mocap.bodies); it streams "
                               "hex1"));
  EXPECT_THAT(found, testing::Not(HasSubstr("every vehicle's")));
}

// Of datagrams to a machine, one program hears each: a second would take them from the first.
TEST_F(MocapLab, WhoWatchesViconTakesNoDatagramsFromWhoFlies) {
  const std::string lab = twoSwap(labFile("vicon_udp"));
  startEmulator("vicon_udp", {"--bodies", "2"});
  start("mocap_bridge", {"--config", lab, "--lcm-url", url()});
  waitUntil("frames", [&] { return heard().frames > 20; });
  const Ended watch = run("roundabout", {"mocap", "watch", lab, "--seconds", "1"});
  EXPECT_EQ(watch.status.code, 2);
  EXPECT_THAT(testing::PrintToString(watch.lines), HasSubstr("is mocap_bridge running"));
  const int before = heard().frames;
  waitUntil("more frames", [&] { return heard().frames > before + 20; });
}

TEST_F(MocapLab, DecodePrintsEveryRecordedFrame) {
  const auto capture = referenceFolder() / "mocap/natnet_v3_mje-nz/extracted/datagrams.bin";
  if (!std::filesystem::exists(capture)) {
    GTEST_SKIP() << "the captured packets are not beside the project";
  }
  const std::filesystem::path printed = scratch_ / "printed.jsonl";
  const std::string command = fmt::format("{}/roundabout mocap decode --protocol natnet {} > {}",
                                          ROUNDABOUT_BIN_DIR, capture.string(), printed.string());
  EXPECT_EQ(std::system(command.c_str()), 0);
  int frames = 0;
  nlohmann::json last;
  std::ifstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line);
    if (json["type"] == "frame") {
      ++frames;
      last = json;
    }
  }
  EXPECT_EQ(frames, 518);
  EXPECT_EQ(last["frame"], 163'251);
  EXPECT_EQ(last["bodies"][0]["name"], "RaceQuad") << "as the model definition among them says";
  EXPECT_EQ(last["bodies"][0]["quaternion"].size(), 4U);
}

TEST_F(MocapLab, WhatIsRecordedIsReplayed) {
  startEmulator("natnet", {"--bodies", "2"});
  const std::string packets = (scratch_ / "lab.packets").string();
  const Ended recorded = run("roundabout", {"mocap", "record", twoSwap(labFile("natnet")), "-o",
                                            packets, "--seconds", "2.5"});
  ASSERT_EQ(recorded.status.code, 0);
  const std::string file = twoSwap("source: replay\nmocap: {file: " + packets + ", speed: 4}\n");
  const Ended replayed = run("mocap_bridge", {"--config", file, "--lcm-url", url()});
  EXPECT_EQ(replayed.status.code, 0);
  EXPECT_GT(heard().frames, 200);
  EXPECT_TRUE(heard().states.vehicles.at(1).tracked);
}

TEST_F(MocapLab, TheVendorsOwnClientReadsOurQtm) {
  const NpmPackage qualisys_rt = npmPackage("qualisys-rt", "0.3.1");
  if (qualisys_rt.modules.empty()) {
    GTEST_SKIP() << qualisys_rt.problem;
  }
  startEmulator("qualisys", {"--bodies", "2"});
  const std::string client = write("client.js", R"(
const qtm = require(process.argv[2] + '/qualisys-rt');
const api = new qtm.Api();
let names = [];
api.on('frame', (data) => {
  console.log(JSON.stringify({names, bodies: data.components['6d'].rigidBodies}));
  process.exit(0);
});
const port = Number(process.argv[3]);
const listening = (resolve) => {
  const probe = require('net').connect(port, '127.0.0.1', () => { probe.destroy(); resolve(); });
  probe.on('error', () => setTimeout(listening, 20, resolve));
};
new Promise(listening)
  .then(() => api.connect(port, '127.0.0.1'))
  .then(() => api.getParameters('6D'))
  .then((parameters) => {
    names = parameters.the6d.body.map((body) => body.name);
    return api.streamFrames({components: ['6D'], frequency: 'AllFrames'});
  })
  .catch((error) => { console.log('failed: ' + error); process.exit(1); });
)");
  const Ended ended =
      run("node", {client, qualisys_rt.modules.string(), std::to_string(command_port_)});
  ASSERT_TRUE(ended.status.clean()) << testing::PrintToString(ended.lines);
  const auto read = nlohmann::json::parse(ended.lines.back());
  EXPECT_EQ(read["names"], (std::vector<std::string>{"hex1", "hex2"}));
  ASSERT_EQ(read["bodies"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    // On circles of 1 and 2 m, at a height of 1 m, the nose along the way; millimetres.
    const auto& body = read["bodies"][i];
    const double x = body["x"];
    const double y = body["y"];
    EXPECT_NEAR(std::hypot(x, y), 1000.0 * static_cast<double>(i + 1), 0.1);
    EXPECT_NEAR(body["z"].get<double>(), 1000.0, 0.1);
    const double heading = std::atan2(y, x) + 1.5707963;
    EXPECT_NEAR(body["rotation"][0].get<double>(), std::cos(heading), 1e-4);
    EXPECT_NEAR(body["rotation"][1].get<double>(), std::sin(heading), 1e-4) << "by columns";
  }
}

}  // namespace
}  // namespace roundabout::test
