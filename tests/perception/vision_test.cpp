// Boxes, and what they say of tracks.

#include <fstream>

#include <gtest/gtest.h>

#include "perception/vision/box_fusion.h"
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
  const auto hog = makePersonDetector("hog", 0.5, "test");
  const std::vector<std::uint8_t> garbage{0xFF, 0xD8, 1, 2, 3};
  EXPECT_FALSE(hog->detect(garbage));
  EXPECT_FALSE(hog->detect({}));
}

}  // namespace
}  // namespace roundabout::perception
