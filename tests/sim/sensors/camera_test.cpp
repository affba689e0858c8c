#include "sim/sensors/camera.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

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
