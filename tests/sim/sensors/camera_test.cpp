#include "sim/sensors/camera.h"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "sim/sensors/depth_camera.h"
#include "sim/sensors/jpeg.h"

namespace roundabout::sim {
namespace {

using Eigen::Vector2d;

class CameraTest : public testing::Test {
 protected:
  static constexpr double kPersonHeightM = 1.75;

  /// Columns and rows in which the image with the person differs from the one without.
  struct Difference {
    int first_column = 1 << 20;
    int last_column = -1;
    int first_row = 1 << 20;
    int last_row = -1;
    int pixels = 0;
  };

  Difference differenceOf(const Vector2d& place_m) {
    const auto bare = camera_.render({0.0, 0.0}, 0.0, stage_, {}, kPersonHeightM);
    const std::vector<std::uint8_t> without(bare.begin(), bare.end());
    Pedestrian person;
    person.id = 1;
    person.position_m = place_m;
    const auto with = camera_.render({0.0, 0.0}, 0.0, stage_, {&person, 1}, kPersonHeightM);
    Difference difference;
    for (int row = 0; row < settings_.height; ++row) {
      for (int column = 0; column < settings_.width; ++column) {
        const auto at = 3 * (static_cast<std::size_t>(row * settings_.width + column));
        if (std::abs(with[at] - without[at]) > 8 || std::abs(with[at + 1] - without[at + 1]) > 8) {
          difference.first_column = std::min(difference.first_column, column);
          difference.last_column = std::max(difference.last_column, column);
          difference.first_row = std::min(difference.first_row, row);
          difference.last_row = std::max(difference.last_row, row);
          ++difference.pixels;
        }
      }
    }
    return difference;
  }

  const config::Camera settings_;
  CameraModel camera_{settings_};
  std::vector<core::Polygon> obstacles_;
  Stage stage_{obstacles_, Eigen::AlignedBox2d(Vector2d(-8.0, -8.0), Vector2d(12.0, 8.0))};
};

TEST_F(CameraTest, APersonStandsWhereThePinholeSays) {
  for (const Vector2d& place_m : {Vector2d(4.0, 0.0), Vector2d(5.0, 1.5), Vector2d(6.0, -2.0)}) {
    const Difference seen = differenceOf(place_m);
    ASSERT_GT(seen.pixels, 200);
    const double column = 0.5 * settings_.width - camera_.focalPx() * place_m.y() / place_m.x();
    EXPECT_NEAR(0.5 * (seen.first_column + seen.last_column), column, 3.0);
    const double foot = 0.5 * settings_.height + camera_.focalPx() * 0.5 / place_m.x();
    const double head = foot - camera_.focalPx() * kPersonHeightM / place_m.x();
    EXPECT_NEAR(seen.last_row, foot, 3.0);
    EXPECT_NEAR(seen.first_row, head, 3.0);
  }
}

TEST_F(CameraTest, NobodyIsSeenBehindItOrBehindFurniture) {
  EXPECT_EQ(differenceOf({-4.0, 0.0}).pixels, 0);
  obstacles_ = {{{2.0, -1.0}, {2.5, -1.0}, {2.5, 1.0}, {2.0, 1.0}}};
  stage_.obstacles = obstacles_;
  EXPECT_EQ(differenceOf({4.0, 0.0}).pixels, 0);
  EXPECT_GT(differenceOf({1.5, 0.0}).pixels, 0);
}

/// A depth camera of 160 x 120 pixels in a room, 0.5 m above the floor, that looks along x.
class DepthCameraTest : public testing::Test {
 protected:
  DepthCameraTest() {
    settings_.width = 160;
    settings_.height = 120;
    settings_.depth = config::DepthSensing{0.3, 6.0, 0.0, 0.0};
    focal_px_ = 80.0 / std::tan(0.6);
  }

  std::vector<std::uint16_t> render(const DepthScene& scene, double heading_rad = 0.0,
                                    core::RandomStream* noise = nullptr) {
    DepthCamera camera(settings_);
    const auto depths = camera.render({0.0, 0.0}, heading_rad, scene, noise);
    return {depths.begin(), depths.end()};
  }
  static std::size_t at(int column, int row) {
    return static_cast<std::size_t>(row * 160 + column);
  }
  /// Of a pixel's ray, a metre of depth.
  double upOf(int row) const { return (59.5 - row) / focal_px_; }

  const Eigen::AlignedBox2d room_{Vector2d(-3.0, -8.0), Vector2d(4.0, 8.0)};
  config::Camera settings_;
  double focal_px_;
};

TEST_F(DepthCameraTest, WallsAndFloorAreAsDeepAsThePinholeSays) {
  const auto depths = render({{}, {}, room_});
  for (const int column : {0, 40, 159}) {
    EXPECT_EQ(depths[at(column, 60)], 4000) << "along the axis, not along the ray";
    EXPECT_EQ(depths[at(column, 0)], 4000);
    EXPECT_NEAR(depths[at(column, 119)], 1000.0 * 0.5 / -upOf(119), 1.0);
  }
  // Turned round it looks at the wall behind, and to the left farther than it can.
  EXPECT_EQ(render({{}, {}, room_}, std::numbers::pi)[at(80, 60)], 3000);
  EXPECT_EQ(render({{}, {}, room_}, std::numbers::pi / 2.0)[at(80, 60)], 0);
  settings_.heading_rad = std::numbers::pi;
  EXPECT_EQ(render({{}, {}, room_})[at(80, 60)], 3000);
}

TEST_F(DepthCameraTest, SeesOverWhatIsLowAndUnderWhatHangs) {
  const std::vector<Prism> prisms = {
      {{{2.0, -0.5}, {2.6, -0.5}, {2.6, 0.5}, {2.0, 0.5}}, 0.0, 0.2},
      {{{2.0, -0.5}, {2.6, -0.5}, {2.6, 0.5}, {2.0, 0.5}}, 0.7, 0.75}};
  const auto depths = render({prisms, {}, room_});
  std::set<std::string> seen;
  for (int row = 0; row < 120; ++row) {
    // The first of the surfaces along the ray.
    const double front_m = 0.5 + 2.0 * upOf(row);
    const double back_m = 0.5 + 2.6 * upOf(row);
    double expected_m = upOf(row) < 0.0 ? std::min(4.0, -0.5 / upOf(row)) : 4.0;
    std::string what = "behind";
    if ((front_m > 0.0 && front_m < 0.2) || (front_m > 0.7 && front_m < 0.75)) {
      expected_m = 2.0;
      what = front_m < 0.5 ? "front" : "edge";
    } else if (front_m > 0.2 && back_m < 0.2) {
      expected_m = -0.3 / upOf(row);
      what = "top";
    } else if (front_m < 0.7 && back_m > 0.7) {
      expected_m = 0.2 / upOf(row);
      what = "underside";
    }
    seen.insert(what);
    EXPECT_NEAR(depths[at(80, row)], 1000.0 * expected_m, 1.0) << row << ' ' << what;
  }
  EXPECT_EQ(seen.size(), 5U);
}

TEST_F(DepthCameraTest, PeopleAreRound) {
  const Cylinder person{{2.0, 0.0}, 0.2, 0.0, 1.0};
  const auto depths = render({{}, {&person, 1}, room_});
  EXPECT_NEAR(depths[at(80, 60)], 1800, 2);
  const int edge = 80 + static_cast<int>(focal_px_ * 0.1);
  EXPECT_GT(depths[at(edge, 60)], 1810);
  EXPECT_LT(depths[at(edge, 60)], 2000);
  EXPECT_EQ(depths[at(80 + static_cast<int>(focal_px_ * 0.11), 60)], 4000);
}

TEST_F(DepthCameraTest, ErrsWithTheSquareOfDepthAndTheSameForASeed) {
  settings_.depth = config::DepthSensing{0.3, 6.0, 0.004, 0.1};
  core::RandomStream first(7, "depth");
  core::RandomStream again(7, "depth");
  const auto depths = render({{}, {}, room_}, 0.0, &first);
  EXPECT_TRUE(depths == render({{}, {}, room_}, 0.0, &again));
  double squares = 0.0;
  int measured = 0;
  constexpr int kRows = 60;  // that see the wall
  for (std::size_t i = 0; i < at(0, kRows); ++i) {
    squares += depths[i] == 0 ? 0.0 : std::pow(depths[i] - 4000.0, 2);
    measured += depths[i] == 0 ? 0 : 1;
  }
  EXPECT_NEAR(std::sqrt(squares / measured), 1000.0 * 0.004 * 16.0, 2.0);
  EXPECT_NEAR(measured / (160.0 * kRows), 0.9, 0.01);
}

TEST_F(CameraTest, TheJpegIsOneAndSmallEnough) {
  const auto rgb = camera_.render({0.0, 0.0}, 0.3, stage_, {}, kPersonHeightM);
  const auto jpeg = encodeJpeg(rgb, settings_.width, settings_.height, 60'000);
  ASSERT_GT(jpeg.size(), 1000U);
  EXPECT_LT(jpeg.size(), 60'000U);
  EXPECT_EQ(jpeg[0], 0xFF);
  EXPECT_EQ(jpeg[1], 0xD8);
  EXPECT_EQ(jpeg[jpeg.size() - 1], 0xD9);
}

TEST(Jpeg, LosesQualityRatherThanGrowTooLarge) {
  std::vector<std::uint8_t> noise(3 * 640 * 480);
  std::uint32_t state = 1;
  for (std::uint8_t& value : noise) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<std::uint8_t>(state >> 24);
  }
  EXPECT_LE(encodeJpeg(noise, 640, 480, 150'000).size(), 150'000U);
}

}  // namespace
}  // namespace roundabout::sim
