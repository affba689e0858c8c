#include <gtest/gtest.h>

#include "perception/evaluation/clear_mot.h"
#include "perception/tracking/tracker.h"

namespace roundabout::perception {
namespace {

constexpr core::Utime kPeriod = 25'000;

/// Bodies where the test puts them, seen or hidden as it says.
class TrackerTest : public ::testing::Test {
 protected:
  TrackerTest() {
    points_.first_bearing_rad = -1.5;
    points_.angle_step_rad = 0.01;
    clearView();
  }

  void clearView() {
    points_.hit.assign(301, 0);
    points_.range_m.assign(301, 10.0);
    points_.world_m.assign(301, Eigen::Vector2d::Zero());
  }
  void hideBehind(double range_m) {
    points_.hit.assign(301, 1);
    points_.range_m.assign(301, range_m);
  }

  static Detection at(double x_m, double y_m) {
    Detection detection;
    detection.position_m = {x_m, y_m};
    detection.covariance_m2 = 0.0025 * Eigen::Matrix2d::Identity();
    detection.legs = 2;
    return detection;
  }

  void see(const std::vector<Detection>& detections) {
    now_ += kPeriod;
    points_.utime = now_;
    tracker_.update(points_, detections);
  }

  Tracker tracker_{config::Perception{}};
  ScanPoints points_;
  core::Utime now_ = 1'000'000;
};

TEST_F(TrackerTest, BelievesWhomItSeesSeveralTimes) {
  see({at(3.0, 0.0)});
  EXPECT_TRUE(tracker_.tracks().empty());
  for (int i = 0; i < 7; ++i) {
    see({at(3.0, 0.0)});
  }
  ASSERT_EQ(tracker_.tracks().size(), 1U);
  EXPECT_EQ(tracker_.tracks()[0].unseen_s, 0.0);
}

TEST_F(TrackerTest, LearnsAVelocityAndItsUncertainty) {
  double deviation_mps = 10.0;
  for (int i = 0; i < 80; ++i) {
    see({at(2.0 + 1.2 * i * 0.025, -1.0)});
    if (i == 20) {
      deviation_mps = tracker_.tracks()[0].velocity_deviation_mps;
    }
  }
  const core::AgentTrack track = tracker_.tracks()[0];
  EXPECT_NEAR(track.velocity_world_mps.x(), 1.2, 0.02);
  EXPECT_NEAR(track.velocity_world_mps.y(), 0.0, 0.02);
  EXPECT_EQ(track.agent_class, core::AgentClass::kPedestrian);
  EXPECT_LT(track.velocity_deviation_mps, deviation_mps);
}

TEST_F(TrackerTest, FollowsWhoWalksBehindSomebodyWithTheSameName) {
  for (int i = 0; i < 40; ++i) {
    see({at(4.0, -1.0 + 1.0 * i * 0.025)});
  }
  const std::int32_t id = tracker_.tracks()[0].id;
  hideBehind(2.0);
  for (int i = 0; i < 30; ++i) {
    see({});
  }
  ASSERT_EQ(tracker_.tracks().size(), 1U);
  EXPECT_NEAR(tracker_.tracks()[0].unseen_s, 0.75, 0.03);
  const double y_m = tracker_.tracks()[0].position_world_m.y();
  EXPECT_GT(y_m, 0.4);
  clearView();
  see({at(4.0, 0.7)});
  ASSERT_EQ(tracker_.tracks().size(), 1U);
  EXPECT_EQ(tracker_.tracks()[0].id, id);
}

TEST_F(TrackerTest, ForgetsSoonerWhoShouldBeSeen) {
  const auto stepsUntilGone = [&] {
    for (int i = 0; i < 40; ++i) {
      see({at(4.0, 0.0)});
    }
    int steps = 0;
    return [this, steps]() mutable {
      while (!tracker_.tracks().empty() && steps < 1000) {
        see({});
        ++steps;
      }
      return steps;
    };
  };
  auto in_view = stepsUntilGone();
  const int seen_steps = in_view();
  auto hidden = stepsUntilGone();
  hideBehind(2.0);
  const int hidden_steps = hidden();
  EXPECT_NEAR(seen_steps * 0.025, 0.5, 0.1);
  EXPECT_NEAR(hidden_steps * 0.025, 2.0, 0.1);
}

TEST_F(TrackerTest, KeepsTwoWhoCrossApart) {
  for (int i = 0; i < 120; ++i) {
    const double t_s = i * 0.025;
    see({at(3.0, -1.5 + t_s), at(3.6, 1.5 - t_s)});
  }
  const auto tracks = tracker_.tracks();
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].id, 1);
  EXPECT_GT(tracks[0].velocity_world_mps.y(), 0.9);
  EXPECT_LT(tracks[1].velocity_world_mps.y(), -0.9);
}

TEST_F(TrackerTest, TakesWhatNeverMovedAndHasNoLegsForFurniture) {
  Detection box = at(3.0, 1.0);
  box.legs = 0;
  box.half_width_m = 0.3;
  for (int i = 0; i < 240; ++i) {
    see({box});
  }
  EXPECT_EQ(tracker_.tracks()[0].agent_class, core::AgentClass::kStatic);
  EXPECT_NEAR(tracker_.tracks()[0].radius_m, 0.3, 0.01);
}

TEST(ClearMot, CountsAsItsInventorsDo) {
  // Two people, four moments: one missed once, one track that is nobody, one exchange of names.
  ClearMot judge(0.5);
  const std::vector<Sighting> truth{{1, {0.0, 0.0}, {1.0, 0.0}}, {2, {3.0, 0.0}, {0.0, 0.0}}};
  judge.add(truth, std::vector<Sighting>{{7, {0.1, 0.0}, {1.0, 0.0}}, {8, {3.0, 0.0}, {0.0, 0.0}}});
  judge.add(truth, std::vector<Sighting>{{7, {0.1, 0.0}, {1.0, 0.0}}, {9, {6.0, 0.0}, {0.0, 0.0}}});
  judge.add(truth, std::vector<Sighting>{{8, {0.0, 0.0}, {1.0, 0.0}}, {7, {3.0, 0.0}, {0.0, 0.0}}});
  judge.add(truth, std::vector<Sighting>{{8, {0.0, 0.0}, {1.0, 0.6}}, {7, {3.0, 0.2}, {0.0, 0.0}}});
  const ClearMot::Result result = judge.result();
  EXPECT_EQ(result.truths, 8);
  EXPECT_EQ(result.misses, 1);
  EXPECT_EQ(result.false_tracks, 1);
  EXPECT_EQ(result.switches, 2);
  EXPECT_DOUBLE_EQ(result.accuracy, 0.5);
  EXPECT_NEAR(result.precision_m, 0.4 / 7.0, 1e-12);
  EXPECT_NEAR(result.velocity_rms_mps, std::sqrt(0.36 / 7.0), 1e-12);
}

TEST(ClearMot, KeepsWhoWasWhomWhileItCan) {
  ClearMot judge(0.5);
  judge.add(std::vector<Sighting>{{1, {0.0, 0.0}}}, std::vector<Sighting>{{7, {0.3, 0.0}}});
  judge.add(std::vector<Sighting>{{1, {0.0, 0.0}}},
            std::vector<Sighting>{{8, {0.0, 0.0}}, {7, {0.4, 0.0}}});
  EXPECT_EQ(judge.result().switches, 0);
  EXPECT_EQ(judge.result().false_tracks, 1);
}

}  // namespace
}  // namespace roundabout::perception
