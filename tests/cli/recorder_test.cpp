#include "cli/recorder.h"

#include <array>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/file_tail.h"
#include "common/bus/lcm_bus.h"
#include "common/core/error.h"
#include "tests/support/lcm_url.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

class RecorderTest : public testing::Test {
 protected:
  void publish(const std::string& text) {
    bus_.publish("REMARK", std::as_bytes(std::span(text.data(), text.size())));
  }
  std::string recorded() const { return fileTail(log_, 1 << 20); }

  test::ScratchFolder scratch_;
  std::filesystem::path log_ = scratch_ / "flight.lcm";
  bus::LcmBus bus_{test::ownLcmUrl()};
};

TEST_F(RecorderTest, HasTheFirstAndTheLastMessage) {
  Recorder recorder(bus_, test::ownLcmUrl(), log_, scratch_ / "logger.log");
  publish("the very first");
  publish("the very last");
  EXPECT_EQ(recorder.close(), "");
  EXPECT_THAT(recorded(), HasSubstr("the very first"));
  EXPECT_THAT(recorded(), HasSubstr("the very last"));
  EXPECT_TRUE(recorder.process().exited());
}

TEST_F(RecorderTest, DoesNotHearAnotherPort) {
  Recorder recorder(bus_, test::ownLcmUrl(), log_, scratch_ / "logger.log");
  bus::LcmBus elsewhere("udpm://239.255.76.67:9999?ttl=0");
  const std::string text = "from elsewhere";
  elsewhere.publish("REMARK", std::as_bytes(std::span(text.data(), text.size())));
  recorder.close();
  EXPECT_THAT(recorded(), Not(HasSubstr("from elsewhere")));
}

TEST_F(RecorderTest, RefusesAFileThatCannotBeWritten) {
  std::ofstream(scratch_ / "file") << "not a folder";
  EXPECT_THROW(
      Recorder(bus_, test::ownLcmUrl(), scratch_ / "file/flight.lcm", scratch_ / "logger.log"),
      core::StartupError);
}

TEST_F(RecorderTest, RefusesToOverwriteALog) {
  std::ofstream(log_) << "precious";
  EXPECT_THROW(Recorder(bus_, test::ownLcmUrl(), log_, scratch_ / "logger.log"),
               core::StartupError);
  EXPECT_EQ(recorded(), "precious");
}

TEST_F(RecorderTest, SaysThatTheLogLacksItsEndWhenTheLoggerHasDied) {
  Recorder recorder(bus_, test::ownLcmUrl(), log_, scratch_ / "logger.log");
  recorder.process().stop(SIGKILL, std::chrono::milliseconds(1000));
  EXPECT_THAT(recorder.close(), HasSubstr("killed by signal 9"));
}

TEST(FileFollower, GivesEveryLineOnceAndWhole) {
  test::ScratchFolder scratch;
  const std::filesystem::path file = scratch / "a.log";
  FileFollower follower(file);
  EXPECT_THAT(follower.newLines(), testing::IsEmpty());
  std::ofstream log(file);
  log << "one\ntw" << std::flush;
  EXPECT_THAT(follower.newLines(), testing::ElementsAre("one"));
  EXPECT_THAT(follower.newLines(), testing::IsEmpty());
  log << "o\nthree\n" << std::flush;
  EXPECT_THAT(follower.newLines(), testing::ElementsAre("two", "three"));
}

}  // namespace
}  // namespace roundabout::cli
