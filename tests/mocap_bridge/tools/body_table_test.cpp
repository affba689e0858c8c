#include "mocap_bridge/tools/body_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace roundabout::mocap_bridge {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr core::Utime kBegin = 1'700'000'000'000'000;

class BodyTableTest : public testing::Test {
 protected:
  BodyTableTest() {
    for (const char* name : {"hex1", "hex2"}) {
      experiment_.vehicles.emplace_back().name = name;
    }
    table_.begin(kBegin);
  }

  // Frames of 100 Hz for a while.
  void stream(double seconds, const std::vector<BodyPose>& bodies) {
    for (const core::Utime end = now_ + core::toUtime(seconds); now_ < end; now_ += 10'000) {
      SourceFrame frame;
      frame.exposure_utime = now_;
      frame.received_utime = now_ + 4'000;
      frame.bodies = bodies;
      table_.add(frame);
      estimator().update(frame);
    }
  }
  static BodyPose body(const std::string& name, std::int64_t id, bool tracked = true) {
    BodyPose pose;
    pose.name = name;
    pose.id = id;
    pose.tracked = tracked;
    return pose;
  }
  StateEstimator& estimator() {
    if (!estimator_) {
      estimator_.emplace(experiment_, "z_up");
    }
    return *estimator_;
  }
  std::string text() { return table_.text(now_, estimator()); }

  config::Experiment experiment_;
  BodyTable table_;
  core::Utime now_ = kBegin;

 private:
  std::optional<StateEstimator> estimator_;
};

TEST_F(BodyTableTest, SaysWhichVehicleABodyIsByItsName) {
  stream(1.0, {body("hex1", 7), body("wand", 8)});
  const std::string shown = text();
  EXPECT_THAT(shown, HasSubstr("100.0 frames a second"));
  EXPECT_THAT(shown, ContainsRegex("hex1 +100\\.0 .* hex1 \\("));
  EXPECT_THAT(shown, ContainsRegex("wand +100\\.0 .* -\n"));
  EXPECT_THAT(shown, ContainsRegex("hex2 +not streamed; hex2 waits for it"));
}

TEST_F(BodyTableTest, SaysWhichVehicleABodyIsByItsStreamingId) {
  experiment_.mocap.bodies = {{"hex1", "", 7, {}, {}}, {"hex2", "", 9, {}, {}}};
  stream(1.0, {body("Hex_1", 7), body("", 9), body("id 7", 11)});
  const std::string shown = text();
  EXPECT_THAT(shown, ContainsRegex("Hex_1 .* hex1 \\("));
  EXPECT_THAT(shown, ContainsRegex("id 9 .* hex2 \\("));
  EXPECT_THAT(shown, ContainsRegex("id 7 .* -\n")) << "a body of that name, which is another";
  EXPECT_THAT(shown, Not(HasSubstr("not streamed")));
}

TEST_F(BodyTableTest, SaysThatABodyIsTwoVehicles) {
  experiment_.mocap.bodies = {{"hex2", "", 7, {}, {}}};
  stream(1.0, {body("hex1", 7)});
  EXPECT_THAT(text(), ContainsRegex("hex1 .* hex1 and hex2: neither is believed\n"));
}

TEST_F(BodyTableTest, ABodyWhoseNameComesLateStaysOneRow) {
  stream(0.5, {body("", 7)});
  stream(0.5, {body("hex1", 7)});
  const std::string shown = text();
  EXPECT_THAT(shown, ContainsRegex("hex1 +100\\.0 "));
  EXPECT_THAT(shown, Not(HasSubstr("id 7")));
}

TEST_F(BodyTableTest, CountsBodiesThatAreNotTrackedAndBodiesThatLeave) {
  stream(0.2, {body("hex1", 1), body("hex2", 2)});
  stream(0.2, {body("hex1", 1, false), body("hex2", 2)});
  stream(0.2, {body("hex1", 1)});
  stream(0.2, {body("hex1", 1), body("hex2", 2)});
  stream(0.2, {});
  const std::string shown = text();
  EXPECT_THAT(shown, ContainsRegex("hex1 .* 2  \\("));
  EXPECT_THAT(shown, ContainsRegex("hex2 .* 2  \\("));
}

TEST_F(BodyTableTest, SaysThatABodyIsGoneAndForgetsIt) {
  stream(0.5, {body("hex1", 1), body("wand", 2)});
  stream(2.0, {body("hex1", 1)});
  EXPECT_THAT(text(), ContainsRegex("wand +gone +2[0-9]{3}\\.0 .* 1  \\("));
  stream(9.0, {body("hex1", 1)});
  EXPECT_THAT(text(), Not(HasSubstr("wand")));
}

TEST_F(BodyTableTest, SaysThatAllAreGoneWhenNoFrameComes) {
  stream(0.5, {body("hex1", 1)});
  text();
  now_ += 3 * core::kMicrosPerSecond;
  EXPECT_THAT(text(), ContainsRegex("hex1 +gone"));
}

}  // namespace
}  // namespace roundabout::mocap_bridge
