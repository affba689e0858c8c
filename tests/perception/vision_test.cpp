// Boxes, and what they say of tracks.

#include <fstream>

#include <gtest/gtest.h>

#include "perception/perception_core.h"
#include "perception/vision/box_fusion.h"
#include "perception/vision/jpeg_size.h"
#include "sim/sensors/camera.h"
#include "sim/sensors/jpeg.h"
#include "sim/sensors/lidar.h"
#include "tests/support/startup_error.h"

namespace roundabout::perception {
namespace {

Track trackAt(double x_m, double y_m) {
  Track track{1, PersonFilter({x_m, y_m}, 0.01 * Eigen::Matrix2d::Identity()), 0, 0, {x_m, y_m}};
  track.confirmed = true;
  return track;
}

TEST(Projection, IsAPinholes) {
  const config::Camera camera;  // 320 x 240 pixels, 1.2 rad, 0.5 m above the floor
  const Projection ahead = project(camera, {{1.0, 0.0}, 0.0}, {5.0, 0.0});
  const double focal_px = 160.0 / std::tan(0.6);
  EXPECT_TRUE(ahead.in_view);
  EXPECT_NEAR(ahead.column, 160.0, 1e-9);
  EXPECT_NEAR(ahead.bottom, 120.0 + focal_px * 0.5 / 4.0, 1e-9);
  EXPECT_NEAR(ahead.top, 120.0 - focal_px * 1.2 / 4.0, 1e-9);
  // At the edge of the field of view, to the left.
  EXPECT_NEAR(project(camera, {}, {std::cos(0.6), std::sin(0.6)}).column, 0.0, 1e-9);
  EXPECT_FALSE(project(camera, {}, {-3.0, 0.0}).in_view);
  config::Camera left = camera;
  left.heading_rad = 1.0;
  EXPECT_NEAR(project(left, {{0.0, 0.0}, 0.5}, {3.0 * std::cos(1.5), 3.0 * std::sin(1.5)}).column,
              160.0, 1e-9);
}

std::vector<std::uint8_t> greyJpeg(int width, int height) {
  return sim::encodeJpeg(
      std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), 128), width, height,
      60'000);
}

TEST(JpegSize, IsWhatTheHeaderSaysHoweverMuchOfItIsThere) {
  const std::vector<std::uint8_t> jpeg = greyJpeg(200, 96);
  EXPECT_EQ(jpegSize(jpeg), (PictureSize{200, 96}));
  bool known = false;
  for (std::size_t length = 0; length <= jpeg.size(); ++length) {
    const auto size = jpegSize(std::span(jpeg).first(length));
    EXPECT_TRUE(!size || *size == (PictureSize{200, 96})) << length;
    EXPECT_TRUE(size || !known) << length;
    known = size.has_value();
  }
  EXPECT_TRUE(known);
  const std::vector<std::uint8_t> no_frame{0xFF, 0xD8, 0xFF, 0xFF, 0xFF, 0xDA, 0, 2};
  EXPECT_FALSE(jpegSize(no_frame));
  const std::vector<std::uint8_t> endless{0xFF, 0xD8, 0xFF, 0xE0, 0, 0, 0xFF, 0xE0};
  EXPECT_FALSE(jpegSize(endless));
}

TEST(JpegSize, OfAnotherPictureThanTheMessageSaysIsRefusedBeforeItIsDecoded) {
  config::Experiment experiment;
  config::Vehicle rover;
  rover.name = "rover";
  rover.lidar = config::Lidar();
  rover.cameras = {config::Camera()};
  experiment.vehicles = {rover};
  PerceptionCore core(experiment, "rover", nullptr);
  const config::Camera& camera = rover.cameras[0];
  EXPECT_EQ(core.onImage(
                0, {1'000'000, camera.width, camera.height, greyJpeg(camera.width, camera.height)}),
            nullptr);
  EXPECT_STREQ(
      core.onImage(0, {2'000'000, camera.width, camera.height, greyJpeg(2 * camera.width, 48)}),
      "its JPEG is of another size than it says");
  // OpenCV would read these too, and ask for as much memory as they say.
  const std::vector<std::uint8_t> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  EXPECT_STREQ(core.onImage(0, {3'000'000, camera.width, camera.height, png}),
               "it is no JPEG, or cut off");
}

TEST(BoxFusion, VotesForWhoStandsNearestInTheBox) {
  const config::Camera camera;
  std::vector<Track> tracks{trackAt(4.0, 0.0), trackAt(4.8, 0.1), trackAt(4.0, 2.0)};
  const Projection at = project(camera, {}, {4.0, 0.0});
  for (int i = 0; i < 5; ++i) {
    fuseBoxes(camera, {},
              std::vector<PersonBox>{{at.column - 20, at.top, at.column + 20, at.bottom, 1.0}},
              tracks);
  }
  EXPECT_GT(tracks[0].camera_person, 0.7);
  EXPECT_LE(tracks[1].camera_person, 0.0);
  EXPECT_LE(tracks[2].camera_person, 0.0);
}

TEST(BoxFusion, DoesNotTakeABoxOfAnotherSize) {
  const config::Camera camera;
  std::vector<Track> tracks{trackAt(8.0, 0.0)};
  fuseBoxes(camera, {}, std::vector<PersonBox>{{100, 10, 220, 235, 1.0}}, tracks);
  EXPECT_LE(tracks[0].camera_person, 0.0);
}

TEST(PersonDetector, SaysWhenBytesAreNoPicture) {
  const auto hog = makePersonDetector({}, "test");
  const std::vector<std::uint8_t> garbage{0xFF, 0xD8, 1, 2, 3};
  EXPECT_FALSE(hog->detect(garbage));
  EXPECT_FALSE(hog->detect({}));
}

/// What a camera at the origin sees of people in a room, as a driver sends it.
class RenderedPeople : public ::testing::Test {
 protected:
  std::vector<std::uint8_t> picture(const std::vector<sim::Pedestrian>& people) {
    const auto rgb = model_.render({0.0, 0.0}, 0.0, stage_, people, 1.75);
    return sim::encodeJpeg(rgb, camera_.width, camera_.height, 60'000);
  }

  static sim::Pedestrian person(int id, double x_m, double y_m, double heading_rad,
                                double speed_mps) {
    sim::Pedestrian person;
    person.id = id;
    person.position_m = {x_m, y_m};
    person.heading_rad = heading_rad;
    person.velocity_mps = speed_mps * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
    person.gait_rad = 1.2;
    return person;
  }

  /// The share of both boxes that they have in common.
  static double overlap(const PersonBox& box, const Projection& at) {
    const double half_px = 0.2 * (at.bottom - at.top);
    const double wide =
        std::min(box.right, at.column + half_px) - std::max(box.left, at.column - half_px);
    const double tall = std::min(box.bottom, at.bottom) - std::max(box.top, at.top);
    const double common = std::max(0.0, wide) * std::max(0.0, tall);
    return common / ((box.right - box.left) * (box.bottom - box.top) +
                     2.0 * half_px * (at.bottom - at.top) - common);
  }

  const config::Camera camera_;
  sim::CameraModel model_{camera_};
  std::vector<core::Polygon> obstacles_;
  sim::Stage stage_{obstacles_, {Eigen::Vector2d(-6.0, -6.0), Eigen::Vector2d(9.0, 6.0)}};
  std::unique_ptr<PersonDetector> hog_ = makePersonDetector({}, "test");
};

TEST_F(RenderedPeople, AreFoundWhereTheyStand) {
  int found = 0;
  int pictures = 0;
  for (const double distance_m : {2.6, 3.0, 3.5, 3.9}) {
    for (int turn = 0; turn < 4; ++turn) {
      const double speed_mps = turn % 2 == 0 ? 0.0 : 1.2;
      const sim::Pedestrian somebody =
          person(turn, distance_m, 0.1 * (turn - 2) * distance_m, 0.8 * turn, speed_mps);
      const auto boxes = hog_->detect(picture({somebody}));
      ASSERT_TRUE(boxes);
      ++pictures;
      ASSERT_LE(boxes->size(), 1U);
      if (boxes->size() == 1) {
        EXPECT_GT(overlap(boxes->front(), project(camera_, {}, somebody.position_m)), 0.4)
            << distance_m << " m, turn " << turn;
        ++found;
      }
    }
  }
  EXPECT_GE(found, pictures - 2);
}

TEST_F(RenderedPeople, AreNotFoundInAnEmptyRoom) {
  obstacles_ = {{{3.0, -1.0}, {3.4, -1.0}, {3.4, -0.5}, {3.0, -0.5}}};
  stage_.obstacles = obstacles_;
  const auto boxes = hog_->detect(picture({}));
  ASSERT_TRUE(boxes);
  EXPECT_TRUE(boxes->empty());
}

TEST_F(RenderedPeople, AreToldFromTheLegsOfAChair) {
  config::Experiment experiment;
  experiment.vehicles.resize(1);
  config::Vehicle& robot = experiment.vehicles.front();
  robot.name = "robot";
  robot.lidar.emplace();
  robot.lidar->beams = 1080;
  robot.lidar->max_range_m = 8.0;
  robot.cameras = {camera_};
  PerceptionCore core(experiment, "robot", makePersonDetector({}, "test"));
  sim::Lidar lidar(*robot.lidar);
  const sim::Pedestrian somebody = person(1, 3.0, 0.6, 0.5, 0.0);
  const Eigen::Vector2d chair_m(3.0, -0.7);
  std::vector<sim::Disc> discs{{chair_m - Eigen::Vector2d(0.0, 0.15), 0.04},
                               {chair_m + Eigen::Vector2d(0.0, 0.15), 0.04}};
  for (const Eigen::Vector2d& leg_m : sim::legsOf(somebody)) {
    discs.push_back({leg_m, 0.06});
  }
  const std::vector<std::uint8_t> jpeg = picture({somebody});
  std::optional<core::AgentTracks> tracks;
  for (core::Utime now = 1'000'000; now <= 3'500'000; now += 25'000) {
    core::StatesFrame frame;
    frame.utime = now;
    frame.vehicles.resize(1);
    frame.vehicles[0].name = "robot";
    frame.vehicles[0].tracked = true;
    core.onFrame(frame);
    const auto seen = lidar.sweep({0.0, 0.0}, 0.0, {discs, {}, nullptr});
    core.onScan({now,
                 seen.first_angle_rad,
                 seen.angle_step_rad,
                 {seen.ranges_m.begin(), seen.ranges_m.end()}});
    if (now % 200'000 == 0) {
      EXPECT_EQ(core.onImage(0, {now, camera_.width, camera_.height, jpeg}), nullptr);
    }
    while (auto said = core.takeTracks()) {
      tracks = std::move(said);
    }
  }
  ASSERT_TRUE(tracks);
  ASSERT_EQ(tracks->tracks.size(), 2U);
  for (const core::AgentTrack& track : tracks->tracks) {
    const bool is_person = track.position_world_m.y() > 0.0;
    EXPECT_EQ(track.agent_class == core::AgentClass::kPedestrian, is_person)
        << track.position_world_m.transpose();
  }
  ASSERT_TRUE(core.boxes().contains(camera_.name));
  ASSERT_EQ(core.boxes().at(camera_.name).size(), 1U);
  EXPECT_GT(overlap(core.boxes().at(camera_.name)[0], project(camera_, {}, somebody.position_m)),
            0.4);
}

}  // namespace
}  // namespace roundabout::perception
