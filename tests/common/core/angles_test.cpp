#include "common/core/angles.h"

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "common/core/vehicle_state.h"

namespace roundabout::core {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(WrapToPi, KeepsWhatIsInRange) {
  EXPECT_DOUBLE_EQ(wrapToPi(0.0), 0.0);
  EXPECT_DOUBLE_EQ(wrapToPi(3.0), 3.0);
  EXPECT_DOUBLE_EQ(wrapToPi(-3.0), -3.0);
}

TEST(WrapToPi, PiBecomesMinusPi) {
  EXPECT_DOUBLE_EQ(wrapToPi(kPi), -kPi);
  EXPECT_DOUBLE_EQ(wrapToPi(-kPi), -kPi);
  EXPECT_DOUBLE_EQ(wrapToPi(3.0 * kPi), -kPi);
}

TEST(WrapToPi, IsInRangeAndTheSameDirectionForAnyAngle) {
  RandomStream random(1, "angles");
  for (int i = 0; i < 10000; ++i) {
    const double angle = random.uniform(-100.0, 100.0);
    const double wrapped = wrapToPi(angle);
    ASSERT_GE(wrapped, -kPi);
    ASSERT_LT(wrapped, kPi);
    ASSERT_NEAR(std::cos(wrapped), std::cos(angle), 1e-12);
    ASSERT_NEAR(std::sin(wrapped), std::sin(angle), 1e-12);
  }
}

TEST(WrapToPi, NeverReachesPiByRounding) {
  double angle = -kPi;
  for (int i = 0; i < 100; ++i) {
    angle = std::nextafter(angle, -10.0);
    ASSERT_LT(wrapToPi(angle), kPi);
    ASSERT_GE(wrapToPi(angle), -kPi);
  }
}

TEST(HeadingOf, IsTheYaw) {
  for (const double heading : {-3.0, -0.5, 0.0, 1e-8, 2.0}) {
    const Eigen::Quaterniond yaw(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()));
    EXPECT_NEAR(headingOf(yaw), heading, 1e-12);
    const Eigen::Quaterniond tilted = yaw * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
    EXPECT_NEAR(headingOf(tilted), heading, 1e-12);
  }
}

}  // namespace
}  // namespace roundabout::core
