#include "fleet/formations/letter.h"

#include <gtest/gtest.h>

#include "common/config/spacing.h"
#include "fleet/formations/spread.h"
#include "fleet/goal_check.h"
#include "tests/fleet/small_fleet.h"

namespace roundabout::fleet {
namespace {

std::vector<Eigen::Vector2d> flat(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector2d> plane;
  for (const Eigen::Vector3d& point : points) {
    plane.push_back(point.head<2>());
  }
  return plane;
}

double distanceToStrokes(const Eigen::Vector2d& point, const std::vector<Stroke>& strokes) {
  double best = std::numeric_limits<double>::infinity();
  for (const Stroke& stroke : strokes) {
    for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
      const Eigen::Vector2d leg = stroke[i + 1] - stroke[i];
      const double along =
          leg.squaredNorm() > 0.0
              ? std::clamp((point - stroke[i]).dot(leg) / leg.squaredNorm(), 0.0, 1.0)
              : 0.0;
      best = std::min(best, (stroke[i] + along * leg - point).norm());
    }
  }
  return best;
}

TEST(Spread, LiesOnTheStrokesAndIsRepeatable) {
  const StrokeFont font;
  for (char character = '!'; character <= '~'; ++character) {
    for (const std::size_t count : {1u, 2u, 5u, 12u}) {
      const auto& strokes = font.strokes(character);
      const auto points = spreadForShape(strokes, count);
      ASSERT_EQ(points.size(), count);
      for (const Eigen::Vector2d& point : points) {
        EXPECT_LT(distanceToStrokes(point, strokes), 1e-9) << character << " " << count;
      }
      EXPECT_EQ(points, spreadForShape(strokes, count));
    }
  }
}

TEST(Spread, ForSpacingIsNeverCloserThanForShape) {
  const StrokeFont font;
  for (char character = '!'; character <= '~'; ++character) {
    for (const std::size_t count : {2u, 6u, 12u}) {
      const auto& strokes = font.strokes(character);
      const auto shapely = spreadForShape(strokes, count);
      const auto spaced = spreadForSpacing(strokes, shapely);
      ASSERT_EQ(spaced.size(), count);
      EXPECT_GE(closestPair(spaced), closestPair(shapely)) << character << " " << count;
      for (const Eigen::Vector2d& point : spaced) {
        EXPECT_LT(distanceToStrokes(point, strokes), 1e-9);
      }
    }
  }
}

TEST(Letter, EveryCharacterAndFleetKeepsItsSpacingOrSaysWhyNot) {
  const StrokeFont font;
  int flown = 0;
  for (char character = '!'; character <= '~'; ++character) {
    for (int count = 1; count <= 20; count += (count < 8 ? 1 : 4)) {
      const config::Experiment experiment = smallFleet(count);
      const PointsOrRefusal result = letterPoints(experiment, font, character);
      if (const auto* points = std::get_if<std::vector<Eigen::Vector3d>>(&result)) {
        ++flown;
        ASSERT_EQ(points->size(), static_cast<std::size_t>(count));
        EXPECT_GE(closestPair(flat(*points)), goalSpacingM(experiment) - 1e-9)
            << character << " " << count;
        EXPECT_FALSE(refuseGoals(experiment, *points));
      } else {
        EXPECT_NE(std::get<std::string>(result).find(character), std::string::npos);
      }
    }
  }
  EXPECT_GT(flown, 800) << "of 94 characters and 11 fleets";
}

TEST(Letter, FillsTheBoxThatWasAskedFor) {
  const config::Experiment experiment = smallFleet(6);
  const auto points =
      std::get<std::vector<Eigen::Vector3d>>(letterPoints(experiment, StrokeFont(), 'H'));
  Eigen::Vector3d low = points[0];
  Eigen::Vector3d high = points[0];
  for (const Eigen::Vector3d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
    EXPECT_DOUBLE_EQ(point.z(), 1.0);
  }
  EXPECT_LE(high.y() - low.y(), 6.0 + 1e-9);
  EXPECT_GE(high.y() - low.y(), 5.0);
  EXPECT_NEAR(0.5 * (high.y() + low.y()), 3.0, 0.3);
}

TEST(Letter, GrowsWhenVehiclesNeedTheSpace) {
  const auto height = [](int count) {
    const auto points =
        std::get<std::vector<Eigen::Vector3d>>(letterPoints(smallFleet(count), StrokeFont(), 'I'));
    double low = 1e9;
    double high = -1e9;
    for (const Eigen::Vector3d& point : points) {
      low = std::min(low, point.y());
      high = std::max(high, point.y());
    }
    return high - low;
  };
  EXPECT_LE(height(3), 6.0 + 1e-9);
  EXPECT_GE(height(9), 8.0 * 1.1 - 1e-6);
}

TEST(Letter, IsRefusedWhenItDoesNotFitTheRoom) {
  config::Experiment experiment = smallFleet(20);
  experiment.room.min_m = {-3.0, -1.0, 0.0};
  experiment.room.max_m = {3.0, 7.0, 3.0};
  const auto result = letterPoints(experiment, StrokeFont(), 'I');
  ASSERT_TRUE(std::holds_alternative<std::string>(result));
  EXPECT_NE(std::get<std::string>(result).find("outside the room"), std::string::npos);
}

TEST(Letter, UsesTheExperimentsOwnPointsWhenThereIsOneForEachVehicle) {
  config::Experiment experiment = smallFleet(2);
  experiment.glyphs = {{"A", {{0, 0, 1}, {3, 0, 1}}}, {"B", {{0, 0, 1}}}};
  EXPECT_EQ(std::get<std::vector<Eigen::Vector3d>>(letterPoints(experiment, StrokeFont(), 'A')),
            experiment.glyphs[0].points_m);
  EXPECT_EQ(
      std::get<std::vector<Eigen::Vector3d>>(letterPoints(experiment, StrokeFont(), 'B')).size(),
      2u);
}

TEST(GoalCheck, NamesGoalsThatAreTooClose) {
  const auto refusal =
      refuseGoals(smallFleet(3), {{0.0, 0.0, 1.0}, {5.0, 0.0, 1.0}, {5.0, 0.4, 1.0}});
  EXPECT_EQ(refusal, "goals 2 and 3 are 0.40 m apart and must be 1.10 m");
}

TEST(GoalCheck, HeightDoesNotMakeGoalsFartherApart) {
  EXPECT_TRUE(refuseGoals(smallFleet(2), {{0.0, 0.0, 1.0}, {0.0, 0.4, 3.0}}));
}

TEST(GoalCheck, NamesGoalsOutsideTheRoom) {
  const auto refusal = refuseGoals(smallFleet(2), {{0.0, 0.0, 1.0}, {19.9, 0.0, 1.0}});
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->find("goal 2 at (19.90, 0.00, 1.00) is outside the room"), 0u) << *refusal;
}

TEST(Goals, AtAnObstacleAreRefused) {
  config::Experiment experiment = smallFleet(2);
  experiment.obstacles = {{"box", {{3.0, -1.0}, {5.0, -1.0}, {5.0, 1.0}, {3.0, 1.0}}}};
  EXPECT_EQ(refuseGoals(experiment, {{0.0, 0.0, 1.0}, {2.5, 0.0, 1.0}}),
            "goal 2 is 0.50 m from obstacle box and must be 0.60 m");
  EXPECT_EQ(refuseGoals(experiment, {{4.0, 0.0, 1.0}}), "goal 1 is inside obstacle box");
  EXPECT_EQ(refuseGoals(experiment, {{2.4, 0.0, 1.0}, {5.5, 1.5, 1.0}}), std::nullopt);
}

TEST(GoalCheck, CountsGoalsAndVehicles) {
  EXPECT_EQ(refuseGoals(smallFleet(1), {{0.0, 0.0, 1.0}, {5.0, 0.0, 1.0}}),
            "2 goals are more than 1 vehicles");
}

}  // namespace
}  // namespace roundabout::fleet
