// A planner that is told what stands around it.

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/planner/fake_flight.h"

namespace roundabout::planner {
namespace {

constexpr double kCell_m = 0.1;

struct Key {
  int x;
  int y;
};

/// The nodes of an OctoMap tree in which these cells of the layer above the floor are occupied.
void writeNode(const std::vector<Key>& cells, int x, int y, int z, int half, std::string& nodes) {
  unsigned bits = 0;
  std::string below;
  for (int child = 0; child < 8; ++child) {
    const int child_x = x + (child & 1 ? half : 0);
    const int child_y = y + (child & 2 ? half : 0);
    const int child_z = z + (child & 4 ? half : 0);
    std::vector<Key> inside;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(inside), [&](const Key& key) {
      return key.x >= child_x && key.x < child_x + half && key.y >= child_y &&
             key.y < child_y + half && child_z <= 0 && 0 < child_z + half;
    });
    if (!inside.empty()) {
      bits |= (half == 1 ? 2U : 3U) << (2 * child);
      if (half > 1) {
        writeNode(inside, child_x, child_y, child_z, half / 2, below);
      }
    }
  }
  nodes += static_cast<char>(bits & 0xFFU);
  nodes += static_cast<char>(bits >> 8U);
  nodes += below;
}

core::OccupancyMap mapOf(const std::vector<Key>& cells) {
  std::string text = "# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0.1\ndata\n";
  writeNode(cells, -32768, -32768, -32768, 32768, text);
  core::OccupancyMap map;
  map.resolution_m = kCell_m;
  map.tree.assign(text.begin(), text.end());
  return map;
}

/// 1.5 m ahead, from 2 m to the right to 0.5 m to the left.
core::OccupancyMap wallAhead() {
  std::vector<Key> cells;
  for (int y = -20; y < 5; ++y) {
    cells.push_back({15, y});
  }
  return mapOf(cells);
}

TEST(MapFlight, SendsThePolicyRoundAWall) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.run(0.1);
  EXPECT_TRUE(flight.script->ego.goal_world_m.isApprox(Eigen::Vector2d(4.0, 0.0)));
  EXPECT_EQ(flight.core.onMap(wallAhead()), nullptr);
  flight.run(0.1);
  const Eigen::Vector2d towards = flight.script->ego.goal_world_m;
  EXPECT_GT(towards.y(), 0.5) << towards.transpose();
}

TEST(MapFlight, DoesNotFlyWhatWouldHitTheWall) {
  FakeFlight flight;
  flight.script->decision = {.speed_mps = 0.5, .heading_change_rad = 0.0};
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.x() = 0.8;
  flight.run(0.1);
  EXPECT_NEAR(flight.run(0.1).command.velocity_world_mps.y(), 0.0, 1e-9);
  ASSERT_EQ(flight.core.onMap(wallAhead()), nullptr);
  const Eigen::Vector3d flown = flight.run(0.1).command.velocity_world_mps;
  // 0.35 m of body and 0.05 m of margin before the wall at 1.5 m, within the next second.
  EXPECT_LT(0.8 + flown.x(), 1.1 + 0.06);
}

TEST(MapFlight, CountsAMapThatIsNone) {
  FakeFlight flight;
  core::OccupancyMap map = wallAhead();
  map.tree.pop_back();
  EXPECT_STREQ(flight.core.onMap(map), "its tree is cut off, or none");
  EXPECT_EQ(flight.run(0.1).status.rejected_messages, 1);
}

}  // namespace
}  // namespace roundabout::planner
