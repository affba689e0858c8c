#include "planner/map/way_finder.h"

#include <gtest/gtest.h>

#include "common/core/polygon.h"
#include "common/core/random.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

const Eigen::AlignedBox2d kRoom{Vector2d(-5.0, -5.0), Vector2d(5.0, 5.0)};

OccupancyGrid emptyRoom() { return {kRoom, 0.1}; }

/// A wall along y at x = 0 with a gap of so many metres at y = 3.
OccupancyGrid roomWithGap(double gap_m) {
  OccupancyGrid grid = emptyRoom();
  grid.occupy({Vector2d(0.0, -4.99), Vector2d(0.05, 3.0 - gap_m / 2.0)});
  if (3.0 + gap_m / 2.0 < 4.99) {
    grid.occupy({Vector2d(0.0, 3.0 + gap_m / 2.0), Vector2d(0.05, 4.99)});
  }
  return grid;
}

double nearest(const OccupancyGrid& grid, const Vector2d& place_m) {
  double nearest_m = 1e9;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      if (grid.occupied({column, row})) {
        nearest_m = std::min(nearest_m, (grid.centreOf({column, row}) - place_m).norm());
      }
    }
  }
  return nearest_m;
}

TEST(WayFinder, GoesStraightWhereNothingStands) {
  const WayFinder finder({}, emptyRoom());
  const auto leg = finder.nextLeg({-3, 0}, {3, 1});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->place_m, Vector2d(3, 1));
  EXPECT_NEAR(leg->way_left_m, std::hypot(6.0, 1.0), 1e-12);
  EXPECT_TRUE(finder.freeBetween({-30, 0}, {30, 1}));
}

TEST(WayFinder, LeadsThroughTheGapWithoutTouching) {
  const OccupancyGrid grid = roomWithGap(1.2);
  const WayFinder finder({.body_radius_m = 0.3, .margin_m = 0.1}, grid);
  Vector2d place(-3.0, -2.0);
  const Vector2d goal(3.0, -2.0);
  double length_m = 0.0;
  double left_m = 15.0;
  while ((place - goal).norm() > 0.05 && length_m < 30.0) {
    const auto next = finder.nextLeg(place, goal);
    ASSERT_TRUE(next);
    EXPECT_LT(next->way_left_m, left_m + 0.15) << "grows shorter, but for the cells' size";
    left_m = next->way_left_m;
    const Vector2d step = 0.05 * (next->place_m - place).normalized();
    place += step;
    length_m += step.norm();
    ASSERT_GT(nearest(grid, place), 0.3) << place.transpose();
  }
  EXPECT_LT((place - goal).norm(), 0.06);
  // Through the middle of the gap and back: 2 x |(3, 5)| = 11.7 m.
  EXPECT_LT(length_m, 13.0);
}

TEST(WayFinder, SaysThatThereIsNoWay) {
  const WayFinder finder({.body_radius_m = 0.3}, roomWithGap(0.5));
  EXPECT_FALSE(finder.nextLeg({-3, 0}, {3, 0}));
  EXPECT_FALSE(finder.nextLeg({-3, 0}, {0.0, 0.0}));
}

TEST(WayFinder, FindsAWayExactlyWhereThereIsOne) {
  // Against flooding: a cell is reached if a neighbour is and it is clear enough.
  core::RandomStream random(5, "rooms");
  for (int room = 0; room < 40; ++room) {
    OccupancyGrid grid({Vector2d(0, 0), Vector2d(3, 3)}, 0.1);
    for (int i = 0; i < 9; ++i) {
      const Vector2d corner(random.uniform(0.3, 2.6), random.uniform(0.3, 2.6));
      grid.occupy({corner, corner + Vector2d(random.uniform(0, 0.8), random.uniform(0, 0.3))});
    }
    const Vector2d start(0.05, 0.05);
    const Vector2d goal(2.95, 2.95);
    const std::vector<float> clearance = grid.clearance(1.0);
    std::vector<bool> reached(clearance.size(), false);
    std::vector<OccupancyGrid::Cell> open{grid.cellAt(start)};
    reached[grid.indexOf(open[0])] = true;
    while (!open.empty()) {
      const OccupancyGrid::Cell cell = open.back();
      open.pop_back();
      for (int up = -1; up <= 1; ++up) {
        for (int right = -1; right <= 1; ++right) {
          const OccupancyGrid::Cell next{cell.column + right, cell.row + up};
          if (grid.contains(next) && !reached[grid.indexOf(next)] &&
              clearance[grid.indexOf(next)] >= 0.25) {
            reached[grid.indexOf(next)] = true;
            open.push_back(next);
          }
        }
      }
    }
    if (clearance[grid.indexOf(grid.cellAt(start))] < 0.25F) {
      continue;
    }
    const WayFinder finder({.body_radius_m = 0.15, .margin_m = 0.05}, grid);
    EXPECT_EQ(!finder.way(start, goal).empty(), reached[grid.indexOf(grid.cellAt(goal))]) << room;
  }
}

TEST(WayFinder, MasksWhatWouldHitAWall) {
  const OccupancyGrid grid = roomWithGap(1.2);
  const WayFinder finder({.body_radius_m = 0.3, .margin_m = 0.1}, grid);
  EXPECT_EQ(finder.maskedVelocity({-3, 0}, {1.2, 0}, 1.0), Vector2d(1.2, 0));
  core::RandomStream random(1, "masks");
  for (int i = 0; i < 500; ++i) {
    const Vector2d place(random.uniform(-1.5, -0.5), random.uniform(-3.0, 4.0));
    const double direction_rad = random.uniform(-3.1, 3.1);
    const Vector2d wanted = 1.2 * Vector2d(std::cos(direction_rad), std::sin(direction_rad));
    const Vector2d flown = finder.maskedVelocity(place, wanted, 1.0);
    EXPECT_LE(flown.norm(), 1.2 + 1e-9);
    for (double time_s = 0.0; time_s <= 1.0; time_s += 0.05) {
      ASSERT_GT(nearest(grid, place + time_s * flown), 0.3);
    }
  }
}

TEST(WayFinder, LetsWhoIsTooNearGoAway) {
  const WayFinder finder({.body_radius_m = 0.3, .margin_m = 0.1}, roomWithGap(1.2));
  EXPECT_TRUE(finder.freeBetween({-0.25, 0.0}, {-1.0, 0.0}));
  EXPECT_FALSE(finder.freeBetween({-0.25, 0.0}, {0.5, 0.0}));
  EXPECT_TRUE(finder.nextLeg({-0.25, 0.0}, {-3.0, 1.0}));
}

TEST(WayFinder, NamesTheNearestCellOfEachDirection) {
  OccupancyGrid grid({Vector2d(-3, -3), Vector2d(3, 3)}, 0.1);
  for (const Vector2d& place :
       {Vector2d(1.05, 0.05), Vector2d(1.55, 0.05), Vector2d(-0.45, -0.95), Vector2d(0.05, 2.55)}) {
    grid.occupy({place, place});
  }
  const WayFinder finder({.body_radius_m = 0.3}, grid);
  std::vector<core::Polygon> cells;
  finder.nearestCells({0.0, 0.0}, 2.0, cells);
  ASSERT_EQ(cells.size(), 2u) << "one is behind another, one out of reach";
  std::vector<Vector2d> centres;
  for (const core::Polygon& cell : cells) {
    ASSERT_EQ(cell.size(), 4u);
    EXPECT_NEAR(core::signedArea(cell), 0.01, 1e-9);
    centres.push_back(0.25 * (cell[0] + cell[1] + cell[2] + cell[3]));
  }
  EXPECT_TRUE(centres[0].isApprox(Vector2d(-0.45, -0.95), 1e-9));
  EXPECT_TRUE(centres[1].isApprox(Vector2d(1.05, 0.05), 1e-9));
  finder.nearestCells({-50.0, 0.0}, 2.0, cells);
  EXPECT_TRUE(cells.empty());
}

// A map of poles and walls, at random.
OccupancyGrid randomMap(core::RandomStream& random) {
  OccupancyGrid grid({Vector2d(-3, -3), Vector2d(3, 3)}, 0.05);
  for (int i = 0; i < 12; ++i) {
    const Vector2d corner(random.uniform(-3, 2.5), random.uniform(-3, 2.5));
    const double long_m = random.uniform(0, 2.0);
    const bool across = i % 2 == 0;
    grid.occupy({corner, corner + Vector2d(across ? long_m : 0.05, across ? 0.05 : long_m)});
  }
  return grid;
}

TEST(WayFinder, WhoKeepsOffTheNearestKeepsOffTheRest) {
  core::RandomStream random(3, "maps");
  for (int i = 0; i < 40; ++i) {
    const OccupancyGrid grid = randomMap(random);
    const Vector2d place(random.uniform(-1, 1), random.uniform(-1, 1));
    if (nearest(grid, place) < 0.35) {
      continue;
    }
    std::vector<core::Polygon> pieces;
    WayFinder({.body_radius_m = 0.3}, grid).nearestCells(place, 3.0, pieces);
    // Half-planes as the shield's, for a body on the spot: of each piece at its nearest point.
    const auto allows = [&](const Vector2d& there, double apart_m) {
      return std::all_of(pieces.begin(), pieces.end(), [&](const core::Polygon& piece) {
        const Vector2d way = core::nearestOnOutline(piece, place) - place;
        return way.normalized().dot(there - place) <= way.norm() - apart_m;
      });
    };
    for (int k = 0; k < 500; ++k) {
      const Vector2d there = place + Vector2d(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
      if (allows(there, 0.3)) {
        EXPECT_GT(nearest(grid, there), 0.3 - 0.05) << i << ": " << there.transpose();
      }
    }
  }
}

TEST(OccupancyGrid, KnowsTheDistanceToTheNearestOccupiedCell) {
  core::RandomStream random(3, "cells");
  for (const int count : {0, 1, 5, 200}) {
    OccupancyGrid grid({Vector2d(0, 0), Vector2d(3.1, 2.2)}, 0.1);
    std::vector<Vector2d> occupied;
    for (int i = 0; i < count; ++i) {
      const Vector2d place(random.uniform(0.0, 3.1), random.uniform(0.0, 2.2));
      grid.occupy({place, place});
      occupied.push_back(grid.centreOf(grid.cellAt(place)));
    }
    const std::vector<float> clearance = grid.clearance(0.7);
    for (int row = 0; row < grid.rows(); ++row) {
      for (int column = 0; column < grid.columns(); ++column) {
        double nearest_m = 0.7;
        for (const Vector2d& place : occupied) {
          nearest_m = std::min(nearest_m, (place - grid.centreOf({column, row})).norm());
        }
        ASSERT_NEAR(clearance[grid.indexOf({column, row})], nearest_m, 1e-5);
      }
    }
  }
}

TEST(OccupancyGrid, RefusesWhatIsNoTree) {
  const char* refusal = nullptr;
  const auto read = [&refusal](const std::string& text) {
    return OccupancyGrid::fromTree(
        {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, kRoom, &refusal);
  };
  const std::string head = "# Octomap OcTree binary file\nid OcTree\n";
  EXPECT_FALSE(read(""));
  EXPECT_FALSE(read("P6\n3 3\n"));
  EXPECT_FALSE(read(head));
  EXPECT_FALSE(read(head + "size 1\nres 0\ndata\n"));
  EXPECT_FALSE(read(head + "size 1\nres 1e-9\ndata\n"));
  EXPECT_FALSE(read(head + "size 1\nres nan\ndata\n"));
  EXPECT_FALSE(read(head + "size 9\nres 0.05\ndata\nx"));
  // Deeper than any tree.
  EXPECT_FALSE(read(head + "size 99\nres 0.05\ndata\n" + std::string(400, '\xFF')));
  EXPECT_TRUE(read(head + "size 0\nres 0.05\ndata\n"));
  EXPECT_FALSE(read(head + "size 0\nres 0.05\ndata\nxx"));
  EXPECT_STREQ(refusal, "its tree is cut off, or too long");
  EXPECT_FALSE(read(head + "res 0.05\ndata\n")) << "without a size";
  EXPECT_FALSE(read(head + "size -1\nres 0.05\ndata\n"));
  EXPECT_STREQ(refusal, "its tree has no header of an OctoMap tree");
}

TEST(OccupancyGrid, RefusesATreeThatIsTooFineForTheRoom) {
  const std::string text = "# Octomap OcTree binary file\nid OcTree\nsize 0\nres 0.01\ndata\n";
  const std::span tree(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const char* refusal = nullptr;
  EXPECT_TRUE(OccupancyGrid::fromTree(tree, {Vector2d(0, 0), Vector2d(9.9, 9.9)}));
  EXPECT_FALSE(OccupancyGrid::fromTree(tree, {Vector2d(0, 0), Vector2d(11, 11)}, &refusal));
  EXPECT_STREQ(refusal, "its resolution is too fine for this room");
}

}  // namespace
}  // namespace roundabout::planner
