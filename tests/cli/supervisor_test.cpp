#include "cli/supervisor.h"

#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"
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

TEST_F(SupervisorTest, RefusesToFlyWhereSomebodyFlies) {
  std::jthread somebody([url = plan_.lcm_url](const std::stop_token& stop) {
    bus::LcmBus bus(url);
    while (!stop.stop_requested()) {
      bus::publish(bus, bus::kStatesChannel, bus::toMessage(core::StatesFrame{1'000'000, 0, {}}));
      bus.handle(std::chrono::milliseconds(5));
    }
  });
  try {
    fly();
    FAIL() << "flew into somebody's flight";
  } catch (const core::StartupError& error) {
    EXPECT_THAT(error.what(), HasSubstr("states of another flight"));
  }
}

}  // namespace
}  // namespace roundabout::cli
