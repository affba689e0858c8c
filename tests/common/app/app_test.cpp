#include "common/app/app.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "common/core/error.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::app {
namespace {

using testing::HasSubstr;
using testing::internal::CaptureStderr;
using testing::internal::CaptureStdout;
using testing::internal::GetCapturedStderr;
using testing::internal::GetCapturedStdout;

struct ProbeOptions {
  static constexpr const char* kName = "probe";
  static constexpr const char* kDescription = "A program for tests.";

  void addOptions(CLI::App& app) { app.add_option("--vehicle", vehicle, "Whose"); }
  std::string label() const { return vehicle.empty() ? kName : "probe:" + vehicle; }

  std::string vehicle;
};

struct Outcome {
  int status;
  std::string out;
  std::string err;
};

class RunProgram : public testing::Test {
 protected:
  RunProgram() {
    std::ofstream(config_)
        << "vehicles: [{name: hex1}]\nlcm_url: udpm://239.255.76.67:7001?ttl=0\n";
    unsetenv("LCM_DEFAULT_URL");
  }

  Outcome run(const std::vector<const char*>& arguments,
              int (*body)(const ProbeOptions&, Context&)) {
    std::vector<const char*> argv = {"probe"};
    std::copy(arguments.begin(), arguments.end(), std::back_inserter(argv));
    CaptureStdout();
    CaptureStderr();
    const int status = app::run<ProbeOptions>(static_cast<int>(argv.size()), argv.data(), body);
    return {status, GetCapturedStdout(), GetCapturedStderr()};
  }

  test::ScratchFolder folder_;
  std::string config_ = folder_ / "lab.yaml";
};

int mustNotRun(const ProbeOptions&, Context&) {
  ADD_FAILURE() << "the program ran";
  return 0;
}

TEST_F(RunProgram, ReturnsWhatTheProgramReturns) {
  const Outcome outcome =
      run({"--config", config_.c_str()}, [](const ProbeOptions&, Context&) { return 7; });
  EXPECT_EQ(outcome.status, 7);
  EXPECT_EQ(outcome.err, "");
}

TEST_F(RunProgram, HandsOverTheExperimentWithOverrides) {
  const Outcome outcome = run({"--config", config_.c_str(), "--set", "seed=5", "--set",
                               "vehicles.0.name=ugv", "--vehicle", "ugv"},
                              [](const ProbeOptions& options, Context& context) {
                                EXPECT_EQ(context.experiment.seed, 5u);
                                EXPECT_EQ(context.experiment.vehicles[0].name, options.vehicle);
                                return 0;
                              });
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(RunProgram, TheUrlOfTheCommandLineIsStrongerThanTheFiles) {
  EXPECT_EQ(run({"--config", config_.c_str(), "--lcm-url", "udpm://239.255.76.67:7002?ttl=0"},
                [](const ProbeOptions&, Context& context) {
                  EXPECT_EQ(context.lcm_url, "udpm://239.255.76.67:7002?ttl=0");
                  return 0;
                })
                .status,
            0);
  EXPECT_EQ(run({"--config", config_.c_str()},
                [](const ProbeOptions&, Context& context) {
                  EXPECT_EQ(context.lcm_url, "udpm://239.255.76.67:7001?ttl=0");
                  return 0;
                })
                .status,
            0);
}

TEST_F(RunProgram, PrintsTheExperimentWithDefaultsInsteadOfRunning) {
  const Outcome outcome = run({"--config", config_.c_str(), "--print-config"}, mustNotRun);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("assumed_radius_m: 0.5"));
}

TEST_F(RunProgram, HelpIsNoError) {
  const Outcome outcome = run({"--help"}, mustNotRun);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("--vehicle"));
  EXPECT_THAT(outcome.out, HasSubstr("--set"));
}

TEST_F(RunProgram, WithoutConfigFailsWithOneLine) {
  const Outcome outcome = run({}, mustNotRun);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "probe: --config is required (try --help)\n");
}

TEST_F(RunProgram, AnUnknownArgumentFailsWithOneLine) {
  const Outcome outcome = run({"--config", config_.c_str(), "--sett", "seed=1"}, mustNotRun);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--sett"));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
}

TEST_F(RunProgram, AnOverrideIsNotTakenForTwo) {
  const Outcome outcome =
      run({"--config", config_.c_str(), "--set", "seed=1", "seed=2"}, mustNotRun);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("seed=2"));
}

TEST_F(RunProgram, AWrongExperimentFailsWithOneLineUnderTheProgramsLabel) {
  const Outcome outcome =
      run({"--config", config_.c_str(), "--set", "seed=x", "--vehicle", "hex1"}, mustNotRun);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "probe:hex1: --set seed: seed: expected a whole number of at least 0, found \"x\"\n");
}

TEST_F(RunProgram, AStartupErrorOfTheProgramIsStatus2) {
  const Outcome outcome =
      run({"--config", config_.c_str()}, [](const ProbeOptions&, Context&) -> int {
        throw core::StartupError("net.safetensors", "lstm/kernel", "71 x 256", "70 x 256");
      });
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "probe: net.safetensors: lstm/kernel: expected 71 x 256, found 70 x 256\n");
}

TEST_F(RunProgram, AnyOtherExceptionIsStatus1) {
  const Outcome outcome =
      run({"--config", config_.c_str()},
          [](const ProbeOptions&, Context&) -> int { throw std::out_of_range("no such thing"); });
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.err, "probe: no such thing\n");
}

TEST_F(RunProgram, LogLinesSayTimeLabelAndLevel) {
  const Outcome outcome =
      run({"--config", config_.c_str(), "--vehicle", "hex1"}, [](const ProbeOptions&, Context&) {
        spdlog::warn("low battery");
        spdlog::debug("detail");
        return 0;
      });
  EXPECT_THAT(outcome.err, testing::MatchesRegex("[0-9][0-9]:[0-9][0-9]:[0-9][0-9]\\.[0-9]+ "
                                                 "probe:hex1 warning  low battery\n"));
}

TEST_F(RunProgram, VerboseLogsDetails) {
  const Outcome outcome =
      run({"--config", config_.c_str(), "--verbose"}, [](const ProbeOptions&, Context&) {
        spdlog::debug("detail");
        return 0;
      });
  EXPECT_THAT(outcome.err, HasSubstr("debug    detail"));
}

TEST_F(RunProgram, ASignalIsARequestToStopNotTheEnd) {
  const Outcome outcome =
      run({"--config", config_.c_str()}, [](const ProbeOptions&, Context& context) {
        EXPECT_FALSE(context.stop.requested());
        raise(SIGTERM);
        EXPECT_TRUE(context.stop.requested());
        return 3;
      });
  EXPECT_EQ(outcome.status, 3);
}

TEST_F(RunProgram, ABrokenPipeIsNotTheEnd) {
  const Outcome outcome = run({"--config", config_.c_str()}, [](const ProbeOptions&, Context&) {
    raise(SIGPIPE);
    return 4;
  });
  EXPECT_EQ(outcome.status, 4);
}

}  // namespace
}  // namespace roundabout::app
