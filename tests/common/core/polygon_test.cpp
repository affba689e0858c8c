#include "common/core/polygon.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace roundabout::core {
namespace {

using Eigen::Vector2d;

const Polygon kSquare = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
const Polygon kAngle = {{0.0, 0.0}, {3.0, 0.0}, {3.0, 3.0}, {2.0, 3.0}, {2.0, 1.0}, {0.0, 1.0}};

TEST(Polygon, AreaIsPositiveWhenCornersGoCounterClockwise) {
  EXPECT_DOUBLE_EQ(signedArea(kSquare), 4.0);
  Polygon turned = kSquare;
  std::reverse(turned.begin(), turned.end());
  EXPECT_DOUBLE_EQ(signedArea(turned), -4.0);
  EXPECT_DOUBLE_EQ(signedArea(kAngle), 5.0);
}

TEST(Polygon, IsSimpleWhenItsSidesMeetInItsCornersOnly) {
  EXPECT_TRUE(isSimple(kSquare));
  EXPECT_TRUE(isSimple(kAngle));
  EXPECT_FALSE(isSimple({{0.0, 0.0}, {1.0, 0.0}}));
  EXPECT_FALSE(isSimple({{0.0, 0.0}, {2.0, 2.0}, {2.0, 0.0}, {0.0, 2.0}})) << "a bow";
  EXPECT_FALSE(isSimple({{0.0, 0.0}, {2.0, 0.0}, {1.0, 0.0}})) << "a line";
  EXPECT_FALSE(isSimple({{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {1.0, 0.0}, {0.0, 2.0}}))
      << "a corner on a side";
  EXPECT_FALSE(isSimple({{0.0, 0.0}, {0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}})) << "a corner twice";
}

TEST(Polygon, IsConvexWithoutACornerThatTurnsRight) {
  EXPECT_TRUE(isConvex(kSquare));
  EXPECT_TRUE(isConvex({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}}));
  EXPECT_FALSE(isConvex(kAngle));
}

TEST(Polygon, DistanceIsToTheNearestPointAndNegativeInside) {
  EXPECT_DOUBLE_EQ(distanceTo(kSquare, {3.0, 1.0}), 1.0);
  EXPECT_DOUBLE_EQ(distanceTo(kSquare, {5.0, 6.0}), 5.0);
  EXPECT_DOUBLE_EQ(distanceTo(kSquare, {1.5, 1.0}), -0.5);
  EXPECT_DOUBLE_EQ(distanceTo(kSquare, {1.0, 0.0}), 0.0);
  EXPECT_DOUBLE_EQ(distanceTo(kAngle, {1.0, 2.0}), 1.0) << "in the notch";
  EXPECT_DOUBLE_EQ(distanceTo(kAngle, {2.5, 2.0}), -0.5);
}

TEST(Polygon, TheNearestPointOfItsOutlineIsASideOrACorner) {
  EXPECT_EQ(nearestOnOutline(kSquare, {1.5, 1.0}), Vector2d(2.0, 1.0));
  EXPECT_EQ(nearestOnOutline(kSquare, {5.0, 6.0}), Vector2d(2.0, 2.0));
  EXPECT_EQ(nearestOnOutline(kAngle, {2.3, 0.7}), Vector2d(2.0, 1.0)) << "from inside, the notch";
}

TEST(Polygon, InsideIsRightWhereARayMeetsCorners) {
  const Polygon diamond = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
  EXPECT_TRUE(contains(diamond, {0.0, 0.0}));
  EXPECT_FALSE(contains(diamond, {-2.0, 0.0}));
  EXPECT_LT(distanceTo(diamond, {0.0, 0.0}), 0.0);
  EXPECT_LT(distanceTo(diamond, {-0.5, 0.0}), 0.0);
  EXPECT_GT(distanceTo(diamond, {-2.0, 0.0}), 0.0);
  EXPECT_GT(distanceTo(diamond, {-2.0, 1.0}), 0.0);
  EXPECT_GT(distanceTo(diamond, {-2.0, -1.0}), 0.0);
}

}  // namespace
}  // namespace roundabout::core
