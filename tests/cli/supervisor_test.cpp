#include "cli/supervisor.h"

#include <fstream>
#include <map>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"
#include "roundabout_msgs/planner_status_t.hpp"
#include "tests/support/lcm_url.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::cli {
namespace {

using testing::HasSubstr;

// With shell scripts in the place of planner, fleet and sim; tests/system flies the real ones.
class SupervisorTest : public testing::Test {
 protected:
  SupervisorTest() {
    plan_.experiment.name = "test";
    plan_.experiment.vehicles.resize(2);
    plan_.experiment.vehicles[0].name = "hex1";
    plan_.experiment.vehicles[1].name = "hex2";
    plan_.lcm_url = test::ownLcmUrl();
    plan_.folder = scratch_ / "out";
    plan_.programs = scratch_ / "bin";
    std::filesystem::create_directories(plan_.programs);
    for (const char* program : {"planner", "fleet", "sim"}) {
      become(program, "exec sleep 1000");
    }
  }

  void become(const std::string& program, const std::string& script) const {
    const std::filesystem::path file = plan_.programs / program;
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }

  // The one that this process started.
  static void killChild(const std::string& name) {
    std::ifstream children("/proc/self/task/" + std::to_string(getpid()) + "/children");
    for (pid_t pid = 0; children >> pid;) {
      std::string command;
      std::ifstream("/proc/" + std::to_string(pid) + "/comm") >> command;
      if (command == name) {
        kill(pid, SIGKILL);
      }
    }
  }

  FlightResult fly() { return Supervisor(plan_, bus_, stop_, console_).run(); }

  test::ScratchFolder scratch_;
  FlightPlan plan_;
  app::StopSignal stop_;
  bus::LcmBus bus_{test::ownLcmUrl()};
  Console console_;
};

TEST_F(SupervisorTest, TellsInItsOwnWordsWhyAProcessDidNotStart) {
  become("fleet", "echo 'fleet: mission[0]: expected room, found none' >&2; exit 2");
  try {
    fly();
    FAIL() << "flew without a fleet";
  } catch (const ChildFailure& failure) {
    EXPECT_STREQ(failure.what(), "fleet: mission[0]: expected room, found none");
  }
}

TEST_F(SupervisorTest, ShowsWhatTheBridgeWarnsOfUpToTheLast) {
  plan_.experiment.source = "natnet";
  become("mocap_bridge",
         "echo '12:00:00.000 mocap_bridge info     2 vehicles' >&2\n"
         "echo '12:00:02.000 mocap_bridge warning  no answer from Motive' >&2\n"
         "echo '12:00:03.000 mocap_bridge warning  connected to Motive' >&2; exit 1");
  testing::internal::CaptureStdout();
  EXPECT_THROW(fly(), ChildFailure);
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            "mocap_bridge: no answer from Motive\nmocap_bridge: connected to Motive\n");
}

TEST_F(SupervisorTest, ShowsNameStatusAndLastLinesOfAProcessThatFailedBeforeTheStart) {
  become("fleet", "echo '12:00:00 fleet info  2 vehicles' >&2; echo oops >&2; exit 1");
  try {
    fly();
    FAIL() << "flew without a fleet";
  } catch (const ChildFailure& failure) {
    EXPECT_STREQ(failure.what(),
                 "fleet: exit status 1 before the flight began\n"
                 "    12:00:00 fleet info  2 vehicles\n"
                 "    oops");
  }
}

TEST_F(SupervisorTest, NamesAProcessThatDiedSilentlyBeforeTheStart) {
  become("planner", "kill -SEGV $$");
  try {
    fly();
    FAIL() << "flew without planners";
  } catch (const ChildFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("planner_hex1: killed by signal 11"));
  }
}

TEST_F(SupervisorTest, RefusesToStartWithoutAProgram) {
  std::filesystem::remove(plan_.programs / "sim");
  EXPECT_THROW(fly(), core::StartupError);
}

TEST_F(SupervisorTest, GivesEveryPlannerItsVehicleTheExperimentAndTheUrl) {
  become("planner", "echo \"$@\"; exec sleep 1000");
  become("sim", "until [ -s ../out/logs/planner_hex2.log ]; do sleep 0.01; done; exit 2");
  std::filesystem::current_path(plan_.programs);
  EXPECT_THROW(fly(), ChildFailure);
  std::ifstream log(plan_.folder / "logs/planner_hex2.log");
  std::string line;
  std::getline(log, line);
  EXPECT_EQ(line, "--config " + (plan_.folder / "experiment.yaml").string() + " --lcm-url " +
                      plan_.lcm_url + " --vehicle hex2");
}

TEST_F(SupervisorTest, EndsAtOnceWhenStoppedBeforeTheFirstState) {
  kill(getpid(), SIGINT);
  const FlightResult result = fly();
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.states_seen);
}

/// The network, until the first state has come; from then on every attempt to listen fails.
class BusThatBreaks final : public bus::Bus {
 public:
  explicit BusThatBreaks(bus::Bus& network) : network_(network) {
    network_.subscribe(bus::kSafetyOrderChannel, [this](const bus::Received&) { ++orders_; });
  }

  void publish(const std::string& channel, std::span<const std::byte> payload) override {
    network_.publish(channel, payload);
  }
  void subscribe(const std::string& channel, Handler handler) override {
    handlers_[channel] = std::move(handler);
  }
  void subscribePrefix(const std::string&, Handler) override {}
  int handle(std::chrono::milliseconds timeout) override {
    network_.handle(timeout);
    if (!std::exchange(broken_, true)) {
      deliver(bus::kStatesChannel, bus::toMessage(core::StatesFrame{1'000'000, 0, {}}));
    } else if (orders_ > 0) {
      // All have landed.
      for (const char* vehicle : {"hex1", "hex2"}) {
        roundabout_msgs::planner_status_t status{};
        status.mode = roundabout_msgs::planner_status_t::LANDED;
        deliver(bus::plannerStatusChannel(vehicle), status);
      }
    }
    throw std::runtime_error("the bus broke");
  }

  int orders() const { return orders_; }

 private:
  template <class Message>
  void deliver(const std::string& channel, const Message& message) {
    handlers_.at(channel)({channel, bus::encode(message), 0});
  }

  bus::Bus& network_;
  std::map<std::string, Handler> handlers_;
  bool broken_ = false;
  int orders_ = 0;
};

TEST_F(SupervisorTest, LandsAllBeforeItGivesUpOnAnError) {
  BusThatBreaks bus(bus_);
  const FlightResult result = Supervisor(plan_, bus, stop_, console_).run();
  EXPECT_GT(bus.orders(), 0);
  EXPECT_THAT(result.events,
              testing::ElementsAre("ended early: roundabout fly failed: the bus broke"));
}

TEST_F(SupervisorTest, SaysThatTheLogIsNotCompleteWhenTheLoggerWasKilled) {
  BusThatBreaks bus(bus_);
  Supervisor supervisor(plan_, bus, stop_, console_);
  killChild("lcm-logger");
  const FlightResult result = supervisor.run();
  EXPECT_FALSE(result.log_complete);
  EXPECT_THAT(result.events, testing::Contains(HasSubstr("the log is not complete")));
}

}  // namespace
}  // namespace roundabout::cli
