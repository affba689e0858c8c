#include "planner/shield/way_round.h"

#include <gtest/gtest.h>

namespace roundabout::planner::shield {
namespace {

using Eigen::Vector2d;

double clearanceOf(const Vector2d& from, const std::vector<Vector2d>& way, const Vector2d& point) {
  double least = 1e9;
  Vector2d last = from;
  for (const Vector2d& place : way) {
    for (int i = 0; i <= 100; ++i) {
      least = std::min(least, (last + 0.01 * i * (place - last) - point).norm());
    }
    last = place;
  }
  return least;
}

TEST(WayRound, IsStraightWhereNothingIsInTheWay) {
  const std::vector<Hindrance> aside{{{Vector2d(2, 3)}, 1.0}};
  const auto way = WayRound().find({0, 0}, {4, 0}, aside);
  ASSERT_TRUE(way);
  EXPECT_EQ(*way, std::vector<Vector2d>{Vector2d(4, 0)});
}

TEST(WayRound, KeepsOffADiscByTheNearerSide) {
  const Vector2d disc(2, 0.1);
  const std::vector<Hindrance> hindrances{{{disc}, 1.0}};
  const auto way = WayRound().find({0, 0}, {4, 0}, hindrances);
  ASSERT_TRUE(way);
  EXPECT_GE(clearanceOf({0, 0}, *way, disc), 0.998);
  EXPECT_LT(way->front().y(), 0.0);
  // Two tangents and an arc, give or take the decagon.
  EXPECT_LT(lengthOf({0, 0}, *way), 4.7);
}

TEST(WayRound, GoesRoundAWallOfDiscsAndAPolygon) {
  std::vector<Hindrance> hindrances;
  for (int i = -2; i <= 2; ++i) {
    hindrances.push_back({{Vector2d(2, 0.8 * i)}, 0.5});
  }
  hindrances.push_back({{Vector2d(1, 2), Vector2d(3, 2), Vector2d(3, 4), Vector2d(1, 4)}, 0.5});
  const auto way = WayRound().find({0, 0.2}, {4, 0.2}, hindrances);
  ASSERT_TRUE(way);
  EXPECT_LT(way->front().y(), -1.5);
  for (const Hindrance& each : hindrances) {
    for (const Vector2d& corner : each.corners_m) {
      EXPECT_GE(clearanceOf({0, 0.2}, *way, corner), 0.498);
    }
  }
}

TEST(WayRound, SaysThatThereIsNoneIntoAClosedRing) {
  std::vector<Hindrance> ring;
  for (int i = 0; i < 8; ++i) {
    ring.push_back({{2.0 * Vector2d(std::cos(0.785398 * i), std::sin(0.785398 * i))}, 0.9});
  }
  EXPECT_FALSE(WayRound().find({5, 0}, {0, 0}, ring));
  ring.pop_back();
  EXPECT_TRUE(WayRound().find({5, 0}, {0, 0}, ring));
}

}  // namespace
}  // namespace roundabout::planner::shield
