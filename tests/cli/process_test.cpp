#include "cli/process.h"

#include <csignal>
#include <fstream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/app/stop_signal.h"
#include "common/core/error.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::cli {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr milliseconds kSoon(10'000);

class ChildProcessTest : public testing::Test {
 protected:
  ProcessCommand shell(const std::string& script) const {
    return {
        .name = "shell", .arguments = {"sh", "-c", script}, .output_file = folder_ / "output.log"};
  }

  // Returns once the script has written something.
  static void waitForOutput(ChildProcess& process) {
    for (int i = 0; i < 1000 && process.lastLines(1).empty(); ++i) {
      process.waitFor(milliseconds(10));
    }
    ASSERT_THAT(process.lastLines(1), ElementsAre("ready"));
  }

  test::ScratchFolder folder_;
};

TEST_F(ChildProcessTest, ReportsTheExitStatus) {
  ChildProcess process(shell("exit 3"));
  const auto status = process.waitFor(kSoon);
  ASSERT_TRUE(status);
  EXPECT_FALSE(status->clean());
  EXPECT_EQ(status->describe(), "exit status 3");
}

TEST_F(ChildProcessTest, ReportsTheSignalThatKilledIt) {
  ChildProcess process(shell("kill -KILL $$"));
  const auto status = process.waitFor(kSoon);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->signal, SIGKILL);
  EXPECT_EQ(status->describe(), "killed by signal 9 (Killed)");
}

TEST_F(ChildProcessTest, SaysNothingWhileItRuns) {
  ChildProcess process(shell("exec sleep 1000"));
  EXPECT_FALSE(process.exited());
  EXPECT_FALSE(process.waitFor(milliseconds(1)));
}

TEST_F(ChildProcessTest, ShowsTheLastLinesOfBothStreams) {
  ChildProcess process(shell("echo one; echo two >&2; echo; echo three"));
  ASSERT_TRUE(process.waitFor(kSoon));
  EXPECT_THAT(process.lastLines(2), ElementsAre("two", "three"));
  EXPECT_THAT(process.lastLines(9), ElementsAre("one", "two", "three"));
}

TEST_F(ChildProcessTest, HasNoLastLinesWhenItWroteNothing) {
  ChildProcess process(shell("exit 0"));
  ASSERT_TRUE(process.waitFor(kSoon));
  EXPECT_THAT(process.lastLines(5), IsEmpty());
}

TEST_F(ChildProcessTest, RefusesAProgramThatDoesNotExist) {
  ProcessCommand command = shell("");
  command.arguments = {"/nowhere/planner"};
  try {
    ChildProcess process(std::move(command));
    FAIL() << "started /nowhere/planner";
  } catch (const core::StartupError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/planner"));
    EXPECT_THAT(error.what(), HasSubstr("No such file"));
  }
}

TEST_F(ChildProcessTest, RefusesAnOutputFileThatCannotBeWritten) {
  ProcessCommand command = shell("");
  command.output_file = folder_ / "missing/output.log";
  EXPECT_THROW(ChildProcess process(std::move(command)), core::StartupError);
}

TEST_F(ChildProcessTest, HasAProcessGroupOfItsOwn) {
  ChildProcess process(shell("echo ready; exec sleep 1000"));
  waitForOutput(process);
  EXPECT_EQ(getpgid(process.pid()), process.pid());
}

TEST_F(ChildProcessTest, HearsSignalsThatItsParentBlocks) {
  const app::StopSignal blocks_signals;
  ChildProcess process(shell("echo ready; exec sleep 1000"));
  waitForOutput(process);
  EXPECT_EQ(process.stop(SIGTERM, kSoon).signal, SIGTERM);
}

TEST_F(ChildProcessTest, IsKilledWhenItDoesNotStopInTime) {
  ChildProcess process(shell("trap '' TERM; echo ready; while :; do sleep 0.01; done"));
  waitForOutput(process);
  EXPECT_EQ(process.stop(SIGTERM, milliseconds(50)).signal, SIGKILL);
}

TEST_F(ChildProcessTest, IsGoneWhenItsObjectIs) {
  pid_t pid = -1;
  {
    ChildProcess process(shell("exec sleep 1000"));
    pid = process.pid();
    ASSERT_EQ(kill(pid, 0), 0);
  }
  EXPECT_EQ(kill(pid, 0), -1);
}

TEST_F(ChildProcessTest, DiesWithItsParentHoweverThatEnds) {
  int pids[2];
  ASSERT_EQ(pipe(pids), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    ChildProcess process(shell("exec sleep 1000"));
    const pid_t pid = process.pid();
    if (write(pids[1], &pid, sizeof(pid)) == sizeof(pid)) {
      kill(getpid(), SIGKILL);
    }
    _exit(1);
  }
  close(pids[1]);
  pid_t grandchild = -1;
  ASSERT_EQ(read(pids[0], &grandchild, sizeof(grandchild)),
            static_cast<ssize_t>(sizeof(grandchild)));
  waitpid(parent, nullptr, 0);
  const auto gone = [grandchild] {
    std::ifstream stat("/proc/" + std::to_string(grandchild) + "/stat");
    std::string pid, name, state;
    return !(stat >> pid >> name >> state) || state == "Z";
  };
  ChildProcess clock(shell("exec sleep 10"));
  while (!gone() && !clock.waitFor(milliseconds(5))) {
  }
  EXPECT_TRUE(gone());
  close(pids[0]);
}

}  // namespace
}  // namespace roundabout::cli
