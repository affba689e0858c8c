#include "logs/replay/log_player.h"

#include <cmath>

#include <gmock/gmock.h>

#include "logs/replay/command_check.h"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr core::Utime kBegin = 1'000'000'000;

/// Ten events, 0.1 s apart, on A and B in turn; payloads count.
class LogPlayerTest : public testing::Test {
 protected:
  LogPlayerTest() {
    write([](int i) { return kBegin + 100'000 * i; });
  }

  void write(const std::function<core::Utime(int)>& log_utime, std::size_t bytes = 20) {
    log_.reset();
    {
      LogWriter writer(folder_.file("log"));
      for (int i = 0; i < 10; ++i) {
        const std::vector<std::byte> payload(bytes, std::byte(i));
        writer.writeBytes(log_utime(i), i % 2 == 0 ? "A" : "B", payload);
      }
    }
    log_ = std::make_unique<EventLog>(folder_.file("log"));
  }

  LogPlayer player(const PlayOptions& options = {}) { return LogPlayer(*log_, options); }

  /// Which events come until a wall time, called every millisecond.
  std::vector<int> until(LogPlayer& player, double wall_s) {
    heard_.clear();
    for (; wall_s_ <= wall_s + 1e-9; wall_s_ += 0.001) {
      player.advance(wall_s_, publish());
    }
    return heard_;
  }

  LogPlayer::Publish publish() {
    return [this](const Event& event) { heard_.push_back(std::to_integer<int>(event.payload[0])); };
  }

  test::ScratchFolder folder_;
  std::unique_ptr<EventLog> log_;
  std::vector<int> heard_;
  double wall_s_ = 50.0;
};

TEST_F(LogPlayerTest, PlaysAtThePaceOfTheRecording) {
  LogPlayer play = player();
  EXPECT_THAT(until(play, 50.25), ElementsAre(0, 1, 2));
  EXPECT_NEAR(play.dueIn(50.25), 0.05, 1e-6);
  EXPECT_THAT(until(play, 50.45), ElementsAre(3, 4));
  until(play, 51.0);
  EXPECT_TRUE(play.atEnd());
  EXPECT_TRUE(std::isinf(play.dueIn(51.0)));
}

TEST_F(LogPlayerTest, PlaysFasterAndSlower) {
  PlayOptions options;
  options.speed = 4.0;
  LogPlayer play = player(options);
  EXPECT_THAT(until(play, 50.06), ElementsAre(0, 1, 2));
  play.setSpeed(wall_s_, 0.5);
  EXPECT_THAT(until(play, 50.10), ElementsAre());
  EXPECT_THAT(until(play, 50.20), ElementsAre(3));
}

TEST_F(LogPlayerTest, PausesAndGoesOnWhereItWas) {
  LogPlayer play = player();
  until(play, 50.25);
  play.pause(wall_s_);
  EXPECT_THAT(until(play, 60.0), ElementsAre());
  EXPECT_TRUE(std::isinf(play.dueIn(60.0)));
  play.play(wall_s_);
  EXPECT_THAT(until(play, 60.06), ElementsAre(3));
}

TEST_F(LogPlayerTest, SeeksForwardsAndBackwards) {
  LogPlayer play = player();
  until(play, 50.15);
  play.seek(wall_s_, 0.75);
  EXPECT_THAT(until(play, 50.25), ElementsAre(8));
  play.seek(wall_s_, 0.0);
  EXPECT_THAT(until(play, 50.3), ElementsAre(0));
  play.seek(wall_s_, -3.0);
  EXPECT_EQ(play.positionS(), 0.0);
  play.seek(wall_s_, 99.0);
  EXPECT_TRUE(play.atEnd());
}

TEST_F(LogPlayerTest, LoopsASpan) {
  PlayOptions options;
  options.from_s = 0.15;
  options.to_s = 0.45;
  options.loop = true;
  LogPlayer play = player(options);
  const std::vector<int> heard = until(play, 50.55);
  EXPECT_THAT(std::vector<int>(heard.begin(), heard.begin() + 5), ElementsAre(2, 3, 4, 2, 3));
}

TEST_F(LogPlayerTest, TakesChannelsInAndOut) {
  PlayOptions options;
  options.only = {"A|B"};
  options.except = {"A"};
  LogPlayer play = player(options);
  EXPECT_THAT(until(play, 51.0), ElementsAre(1, 3, 5, 7, 9));
}

TEST_F(LogPlayerTest, StepsEventByEventWithoutStates) {
  PlayOptions options;
  options.paused = true;
  LogPlayer play = player(options);
  EXPECT_THAT(until(play, 50.5), ElementsAre());
  play.step(wall_s_, publish());
  play.step(wall_s_, publish());
  EXPECT_THAT(heard_, ElementsAre(0, 1));
  EXPECT_TRUE(play.paused());
}

TEST_F(LogPlayerTest, StepsFrameByFrameWithStates) {
  SyntheticFlight flight;
  flight.vehicles = {{"hex1", standing({0, 0, 1})}};
  flight.write(folder_.file("flight"));
  const EventLog log(folder_.file("flight"));
  LogPlayer play(log, {});
  std::vector<std::string> heard;
  for (int i = 0; i < 3; ++i) {
    play.step(0.0, [&](const Event& event) { heard.emplace_back(event.channel); });
    EXPECT_EQ(heard.back(), "VEHICLE_STATES");
  }
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "VEHICLE_STATES"), 3);
}

TEST_F(LogPlayerTest, ACorruptTimeStopsNothing) {
  write([](int i) { return i == 4 ? kBegin + (1LL << 50) : i == 6 ? 5 : kBegin + 100'000 * i; });
  LogPlayer play = player();
  EXPECT_EQ(until(play, 51.0).size(), 10u);
}

TEST_F(LogPlayerTest, NeverFloodsButSlowsDown) {
  write([](int) { return kBegin; }, 20'000);
  LogPlayer play = player();
  play.advance(wall_s_, publish());
  EXPECT_EQ(heard_.size(), 2u);  // of 20 kB each
  play.advance(wall_s_ + 0.001, publish());
  EXPECT_EQ(heard_.size(), 4u);
  EXPECT_EQ(play.dueIn(wall_s_ + 0.001), 0.0);
}

TEST_F(LogPlayerTest, HandsOutNoMoreThanAStockListenerKeeps) {
  SyntheticFlight flight;
  flight.vehicles = {{"hex1", standing({0, 0, 1})}};
  flight.write(folder_.file("flight"));
  const EventLog log(folder_.file("flight"));
  PlayOptions options;
  options.speed = 1e6;
  LogPlayer play(log, options);
  std::size_t all = 0;
  for (double wall_s = 1.0; !play.atEnd(); wall_s += 0.001) {
    std::size_t at_once = 0;
    play.advance(wall_s, [&](const Event&) { ++at_once; });
    EXPECT_LE(at_once, LogPlayer::kMostEvents);
    all += at_once;
  }
  EXPECT_EQ(all, log.size());
}

class CommandCheckTest : public testing::Test {
 protected:
  CommandCheckTest() {
    SyntheticFlight flight;
    flight.vehicles = {{"hex1", straight({0, 0, 1}, {3, 0, 1}, 0.5)},
                       {"hex2", standing({0, 4, 1})}};
    flight.write(folder_.file("flight"));
    flight_ = readFlight(folder_.file("flight"));
    for (const auto& command : hex1().commands) {
      again_[command.value.state_utime] = command.value;
    }
  }
  const FlightVehicle& hex1() const { return flight_.vehicles[0]; }

  test::ScratchFolder folder_;
  Flight flight_;
  std::map<core::Utime, core::Command> again_;
};

TEST_F(CommandCheckTest, PassesWhatIsEqual) {
  const CommandCheck check = checkCommands(flight_, hex1(), again_);
  EXPECT_TRUE(check.passed());
  EXPECT_GT(check.pairs.size(), 50u);
  EXPECT_EQ(answeredFrames(flight_, hex1()).size(), check.pairs.size());
}

TEST_F(CommandCheckTest, ShowsTheFirstDifferenceWithTheStatesAroundIt) {
  auto different = std::next(again_.begin(), 30);
  different->second.velocity_world_mps.y() = std::nextafter(0.0, 1.0);
  std::next(different, 5)->second.mode = core::CommandMode::kLand;
  const CommandCheck check = checkCommands(flight_, hex1(), again_);
  EXPECT_FALSE(check.passed());
  EXPECT_EQ(check.firstDifference(), 30u);
  EXPECT_EQ(check.equal(), check.pairs.size() - 2);
  const std::string text = toText(flight_, hex1(), check);
  EXPECT_THAT(text, HasSubstr("first difference: command 31 of"));
  EXPECT_THAT(text, HasSubstr("at 3.000 s"));
  EXPECT_THAT(text, HasSubstr("* hex1"));
  EXPECT_THAT(text, HasSubstr("1.5000"));  // where it was
}

TEST_F(CommandCheckTest, MissesAnswersAndCountsExtraOnes) {
  const core::Utime first = again_.begin()->first;
  again_.erase(first);
  again_[first + 5000] = {};
  const CommandCheck check = checkCommands(flight_, hex1(), again_);
  EXPECT_EQ(check.firstDifference(), 0u);
  EXPECT_EQ(check.extra, 1);
  EXPECT_THAT(toText(flight_, hex1(), check), HasSubstr("no answer"));
}

TEST_F(CommandCheckTest, OfNothingDoesNotPass) {
  flight_.vehicles[0].commands.clear();
  EXPECT_FALSE(checkCommands(flight_, hex1(), {}).passed());
}

}  // namespace
}  // namespace roundabout::logs
