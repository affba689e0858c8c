#include "planner/map/way_finder.h"

#include <gtest/gtest.h>

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
  EXPECT_EQ(finder.nextPlace({-3, 0}, {3, 1}), Vector2d(3, 1));
  EXPECT_TRUE(finder.freeBetween({-30, 0}, {30, 1}));
}

TEST(WayFinder, LeadsThroughTheGapWithoutTouching) {
  const OccupancyGrid grid = roomWithGap(1.2);
  const WayFinder finder({.body_radius_m = 0.3, .margin_m = 0.1}, grid);
  Vector2d place(-3.0, -2.0);
  const Vector2d goal(3.0, -2.0);
  double length_m = 0.0;
  while ((place - goal).norm() > 0.05 && length_m < 30.0) {
    const auto next = finder.nextPlace(place, goal);
    ASSERT_TRUE(next);
    const Vector2d step = 0.05 * (*next - place).normalized();
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
  EXPECT_FALSE(finder.nextPlace({-3, 0}, {3, 0}));
  EXPECT_FALSE(finder.nextPlace({-3, 0}, {0.0, 0.0}));
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
  EXPECT_TRUE(finder.nextPlace({-0.25, 0.0}, {-3.0, 1.0}));
}

TEST(OccupancyGrid, RefusesWhatIsNoTree) {
  const auto read = [](const std::string& text) {
    return OccupancyGrid::fromTree(
        {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, kRoom);
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
}

}  // namespace
}  // namespace roundabout::planner
