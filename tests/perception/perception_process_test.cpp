// The real programs on a real port.

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>

#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "tests/perception/crowd.h"
#include "tests/support/lcm_url.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::perception {
namespace {

/// A program of the build; killed if the test forgets it.
class Program {
 public:
  explicit Program(std::vector<std::string> arguments) {
    arguments[0] = fmt::format("{}/{}", ROUNDABOUT_BIN_DIR, arguments[0]);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) {
      pointers.push_back(argument.data());
    }
    pointers.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&pid_, pointers[0], nullptr, nullptr, pointers.data(), environ), 0);
  }
  ~Program() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  /// Exit status; -1: it died of a signal.
  int end(int signal) {
    kill(pid_, signal);
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = 0;
};

TEST(PerceptionProcess, TracksPeopleUntilItIsStoppedAndLeavesItsMap) {
  const test::ScratchFolder folder;
  std::ofstream(folder.file("lab.yaml"))
      << "room: {min_m: [-8, -8, 0], max_m: [8, 8, 3]}\n"
         "vehicles: [{name: robot, model: unicycle, lidar: {beams: 1080, max_range_m: 10}}]\n"
         "perception: {map_file: "
      << folder.file("world.bt") << "}\n";
  const std::string url = test::ownLcmUrl();
  bus::LcmBus lab(url);
  std::vector<roundabout_msgs::agent_tracks_t> heard;
  bus::subscribe<roundabout_msgs::agent_tracks_t>(
      lab, "AGENT_TRACKS_robot",
      [&](const roundabout_msgs::agent_tracks_t& message) { heard.push_back(message); },
      [](const bus::DecodeError& error) { ADD_FAILURE() << error.reason; });
  Program program(
      {"perception", "--config", folder.file("lab.yaml"), "--vehicle", "robot", "--lcm-url", url});
  test::Crowd crowd({.walls = true});
  core::StatesFrame frame;
  frame.vehicles.resize(1);
  frame.vehicles[0].name = "robot";
  frame.vehicles[0].tracked = true;
  const auto sees = [&] { return !heard.empty() && heard.back().num_tracks >= 4; };
  for (int i = 0; i < 1200 && !sees(); ++i) {
    crowd.step(0.025);
    core::LaserScan scan = crowd.scan();
    frame.utime = scan.utime;
    bus::publish(lab, "LASER_SCAN_robot", bus::toMessage(scan));
    bus::publish(lab, "VEHICLE_STATES", bus::toMessage(frame));
    lab.handle(std::chrono::milliseconds(20));
  }
  EXPECT_TRUE(sees());
  EXPECT_EQ(program.end(SIGTERM), 0);
  EXPECT_GT(std::filesystem::file_size(folder / "world.bt"), 1000U);
}

TEST(PerceptionProcess, NamesAModelThatDoesNotLoad) {
  const test::ScratchFolder folder;
  std::ofstream(folder.file("lab.yaml"))
      << "vehicles: [{name: robot, model: unicycle, lidar: {beams: 90}}]\n";
  std::ofstream(folder.file("broken.onnx")) << "no network";
  for (const auto& model : {folder.file("broken.onnx"), folder.file("missing.onnx")}) {
    const std::string command =
        fmt::format("{}/perception --vehicle robot --config {} --set perception.detector={} 2> {}",
                    ROUNDABOUT_BIN_DIR, folder.file("lab.yaml"), model, folder.file("said"));
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
    std::ifstream file(folder.file("said"));
    std::string line;
    std::string last;
    while (std::getline(file, line)) {
      last = line;
    }
    EXPECT_NE(last.find("perception.detector: expected"), std::string::npos) << last;
    EXPECT_NE(last.find(model), std::string::npos) << last;
  }
}

}  // namespace
}  // namespace roundabout::perception
