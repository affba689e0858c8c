#include <csignal>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "logs/reading/event_log.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using roundabout_msgs::planner_status_t;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class Fly : public FlightLab {
 protected:
  // From take-off on there is something to land.
  void waitForFlight() {
    waitUntil("two in the air",
              [this] { return heightOf("hex1") > 0.5 && heightOf("hex2") > 0.5; });
  }
};

TEST_F(Fly, EndsWithStatusZeroAndLeavesLogMetricsReportAndPictures) {
  const Ended flight = finish(startFlight(twoSwap()));
  EXPECT_TRUE(flight.status.clean()) << flight.status.describe();
  EXPECT_THAT(flight.lines, Contains(HasSubstr("1 of 1 formations formed, no bodies touched")));
  EXPECT_THAT(flight.lines, Contains(HasSubstr(out().string())));
  for (const char* file : {"experiment.yaml", "flight.lcm", "metrics.json", "report.html",
                           "logs/sim.log", "logs/fleet.log", "logs/planner_hex1.log",
                           "logs/planner_hex2.log", "logs/lcm-logger.log"}) {
    EXPECT_TRUE(std::filesystem::exists(out() / file)) << file;
  }
  const auto pictures = std::count_if(
      std::filesystem::directory_iterator(out()), std::filesystem::directory_iterator(),
      [](const auto& entry) { return entry.path().extension() == ".png"; });
  EXPECT_GE(pictures, 2);
  EXPECT_THAT(leftRunning(), IsEmpty());
}

TEST_F(Fly, LogsEveryFrameFromTheFirstOn) {
  finish(startFlight(twoSwap()));
  std::ifstream file(out() / "metrics.json");
  const auto metrics = nlohmann::json::parse(file);
  EXPECT_EQ(metrics["timing"]["missing_frames"], 0);
  EXPECT_GT(metrics["timing"]["frames"], 200);
}

TEST_F(Fly, RepeatsStatesAndCommandsByteForByte) {
  const std::string file = twoSwap();
  finish(startFlight(file, {"--no-report"}));
  const auto first = payloadsOf(out() / "flight.lcm");
  std::filesystem::rename(out(), scratch_ / "first");
  finish(startFlight(file, {"--no-report"}));
  const auto second = payloadsOf(out() / "flight.lcm");
  for (const char* channel : {"VEHICLE_STATES", "COMMAND_hex1", "COMMAND_hex2"}) {
    ASSERT_FALSE(first.at(channel).empty()) << channel;
    EXPECT_EQ(first.at(channel).size(), second.at(channel).size()) << channel;
    EXPECT_TRUE(first.at(channel) == second.at(channel)) << channel << " differs";
  }
}

TEST_F(Fly, FliesDifferentlyWithAnotherSeed) {
  const std::string file = twoSwap();
  finish(startFlight(file, {"--no-report"}));
  const auto first = payloadsOf(out() / "flight.lcm");
  std::filesystem::rename(out(), scratch_ / "first");
  finish(startFlight(file, {"--no-report", "--seed", "4"}));
  EXPECT_TRUE(first.at("VEHICLE_STATES") != payloadsOf(out() / "flight.lcm").at("VEHICLE_STATES"));
}

TEST_F(Fly, LandsAllAndClosesTheLogOnCtrlC) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time"});
  waitForFlight();
  flight.signal(SIGINT);
  const Ended ended = finish(flight);
  EXPECT_EQ(ended.status.code, 130);
  EXPECT_THAT(ended.lines, Contains(HasSubstr("landing all: stopped by the user")));
  EXPECT_EQ(modeOf("hex1"), int{planner_status_t::LANDED});
  EXPECT_EQ(modeOf("hex2"), int{planner_status_t::LANDED});
  EXPECT_LT(heightOf("hex1"), 0.1);
  EXPECT_LT(heightOf("hex2"), 0.1);
  EXPECT_TRUE(logs::EventLog((out() / "flight.lcm").string()).damage().empty());
  EXPECT_TRUE(std::filesystem::exists(out() / "report.html"));
  EXPECT_THAT(leftRunning(), IsEmpty());
}

TEST_F(Fly, RefusesToStartBesideAPlannerThatWasForgotten) {
  start("planner", {"--config", twoSwap(), "--vehicle", "hex1", "--lcm-url", url()});
  waitUntil("the planner", [this] { return modeOf("hex1") >= 0; });
  const Ended flight = finish(startFlight(twoSwap()));
  EXPECT_EQ(flight.status.code, 2);
  EXPECT_THAT(flight.lines.back(), HasSubstr("found PLANNER_STATUS_hex1"));
}

TEST_F(Fly, LandsAllWhenItsTerminalCloses) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
  waitForFlight();
  flight.signal(SIGHUP);
  waitUntil("landing", [this] { return modeOf("hex1") == planner_status_t::LANDING; });
  flight.signal(SIGHUP);
  EXPECT_EQ(finish(flight).status.code, 130);
  EXPECT_EQ(modeOf("hex1"), int{planner_status_t::LANDED});
  EXPECT_EQ(modeOf("hex2"), int{planner_status_t::LANDED});
}

TEST_F(Fly, OutlivesWhoeverReadsWhatItSays) {
  const std::string command = std::string(ROUNDABOUT_BIN_DIR) + "/roundabout fly " + twoSwap() +
                              " --lcm-url " + url() + " --out " + out().string();
  const std::string status = (scratch_ / "status").string();
  run("sh", {"-c", "{ " + command + "; echo $? >" + status + "; } | head -n 1"});
  waitUntil("the end", [&] { return std::filesystem::exists(status); });
  std::ifstream file(status);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "0\n");
  EXPECT_TRUE(std::filesystem::exists(out() / "report.html"));
}

TEST_F(Fly, NeedsNoStandardOutput) {
  const std::string command = std::string(ROUNDABOUT_BIN_DIR) + "/roundabout fly " + twoSwap() +
                              " --lcm-url " + url() + " --out " + out().string();
  EXPECT_TRUE(run("sh", {"-c", "exec " + command + " <&- >&- 2>&-"}).status.clean());
  EXPECT_TRUE(std::filesystem::exists(out() / "report.html"));
}

TEST_F(Fly, LandsAllWhenAMissionEndsInTheAir) {
  const Ended flight =
      finish(startFlight(write("aloft.yaml",
                               "name: aloft\nvehicles: [{name: hex1}, {name: hex2}]\n"
                               "mission: [take_off, {formation: {name: pair, points: [[0, 0], [2, "
                               "0]], seconds: 0.5}}]\n"),
                         {"--no-report"}));
  EXPECT_TRUE(flight.status.clean()) << flight.status.describe();
  EXPECT_THAT(flight.lines, Contains(HasSubstr("landing all: the mission is over")));
  EXPECT_EQ(modeOf("hex1"), int{planner_status_t::LANDED});
  EXPECT_LT(heightOf("hex2"), 0.1);
}

/// On a machine of its own making: only what is in a folder can be found.
class FlyWithoutGnuplot : public Fly {
 protected:
  FlyWithoutGnuplot() {
    std::filesystem::create_directory(programs_);
    std::filesystem::create_symlink("/usr/bin/lcm-logger", programs_ / "lcm-logger");
  }

  cli::ChildProcess& startThere() {
    return start("env",
                 {"PATH=" + programs_.string(), std::string(ROUNDABOUT_BIN_DIR) + "/roundabout",
                  "fly", twoSwap(), "--lcm-url", url(), "--out", out().string()});
  }

  const std::filesystem::path programs_ = scratch_ / "programs";
};

TEST_F(FlyWithoutGnuplot, SaysHowItWentAlthoughItCannotDraw) {
  const Ended flight = finish(startThere());
  EXPECT_TRUE(flight.status.clean()) << flight.status.describe();
  EXPECT_THAT(flight.lines, Contains(HasSubstr("SUCCESS")));
  EXPECT_THAT(flight.lines, Contains(HasSubstr("gnuplot")));
  EXPECT_TRUE(std::filesystem::exists(out() / "metrics.json"));
}

TEST_F(FlyWithoutGnuplot, EndsTheReportOnCtrlC) {
  std::ofstream(programs_ / "gnuplot")
      << "#!/bin/sh\nexec /usr/bin/tail --pid=$PPID --follow /dev/null\n";
  std::filesystem::permissions(programs_ / "gnuplot", std::filesystem::perms::owner_all);
  cli::ChildProcess& flight = startThere();
  waitUntil("the report", [this] { return std::filesystem::exists(out() / "metrics.json"); });
  flight.signal(SIGINT);
  EXPECT_EQ(finish(flight).status.signal, SIGINT);
}

TEST_F(Fly, EndsAtOnceOnASecondCtrlC) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
  waitForFlight();
  flight.signal(SIGINT);
  waitUntil("landing", [this] { return modeOf("hex1") == planner_status_t::LANDING; });
  flight.signal(SIGINT);
  EXPECT_EQ(finish(flight).status.code, 130);
  EXPECT_GT(heightOf("hex1"), 0.2);
  EXPECT_THAT(leftRunning(), IsEmpty());
}

TEST_F(Fly, LeavesNothingRunningWhenItIsKilled) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time"});
  waitForFlight();
  flight.signal(SIGKILL);
  finish(flight);
  waitUntil("all processes to end", [this] { return leftRunning().empty(); });
}

TEST_F(Fly, RefusesToStartIntoAFlight) {
  cli::ChildProcess& flight = startFlight(twoSwap(), {"--real-time", "--no-report"});
  waitForFlight();
  const Ended second = run("roundabout", {"fly", twoSwap(), "--lcm-url", url(), "--out",
                                          (scratch_ / "second").string()});
  EXPECT_EQ(second.status.code, 2);
  EXPECT_THAT(second.lines.back(), HasSubstr("found VEHICLE_STATES"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "second"));
  EXPECT_FALSE(flight.exited());
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

// From /proc: the most memory that a process has had resident so far.
long peakMemoryKilobytes(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;) {
    if (long kilobytes = 0; word == "VmHWM:" && status >> kilobytes) {
      return kilobytes;
    }
  }
  return -1;
}

TEST_F(Fly, APlannerAmongSixVehiclesStaysBelowTwentyMegabytes) {
  if (kSanitized) {
    GTEST_SKIP() << "sanitizers take memory of their own";
  }
  startFlight(ROUNDABOUT_SOURCE_DIR "/experiments/spell_cadrl.yaml", {"--no-report"});
  waitUntil("the first letter", [this] { return heard().fleet.formation == "C"; });
  const auto planner = findProcess({"planner", "hex1"});
  ASSERT_TRUE(planner.has_value());
  const long kilobytes = peakMemoryKilobytes(*planner);
  EXPECT_GT(kilobytes, 1'000);
  EXPECT_LT(kilobytes, 20'000);
}

TEST_F(Fly, SaysThatAMissionWasNotFlown) {
  const Ended flight = finish(startFlight(twoSwap("fleet: {step_timeout_s: 3.0}\n")));
  EXPECT_EQ(flight.status.code, 1);
  EXPECT_THAT(flight.lines, Contains(HasSubstr("0 of 1 formations formed")));
}

}  // namespace
}  // namespace roundabout::test
