// The map as perception makes it, as OctoMap reads it, and as the planner reads it.

#include <sstream>

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include "perception/clustering/table.h"
#include "perception/mapping/occupancy_mapper.h"
#include "planner/map/occupancy_grid.h"
#include "tests/perception/crowd.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::perception {
namespace {

const Eigen::AlignedBox2d kBounds{Eigen::Vector2d(-8, -8), Eigen::Vector2d(8, 8)};

/// A room with walls 7 m away in which six people walk, mapped at 10 Hz for a while.
class MapOfARoom : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    test::Crowd crowd({.beams = 540, .walls = true});
    AgentFinder finder({}, makeClusterer("breakpoints", "test"));
    mapper_ = std::make_unique<OccupancyMapper>(0.05, kBounds);
    auto cells = mapper_->cells();
    for (int i = 0; i < 240; ++i) {
      crowd.step(0.025);
      finder.update(crowd.scan(), {}, {}, cells.get());
      if (i % 4 == 0) {
        mapper_->insert(mapUpdateOf(finder, 6.0));
        cells = mapper_->cells();
      }
    }
    people_ = crowd.truth();
  }
  static void TearDownTestSuite() { mapper_.reset(); }

  static inline std::unique_ptr<OccupancyMapper> mapper_;
  static inline std::vector<Sighting> people_;
};

TEST_F(MapOfARoom, HasItsWallsAndNobodyInIt) {
  const auto cells = mapper_->cells();
  EXPECT_TRUE(cells->occupied({7.0, 0.0}));
  EXPECT_TRUE(cells->occupied({0.0, -7.0}));
  for (const Eigen::Vector2d& centre_m : cells->centres()) {
    EXPECT_GT(centre_m.cwiseAbs().maxCoeff(), 6.8) << centre_m.transpose();
  }
}

TEST_F(MapOfARoom, IsReadByOctoMapAndThePlannerAlike) {
  const std::vector<std::uint8_t> tree = mapper_->binaryTree();
  std::stringstream stream(std::string(tree.begin(), tree.end()));
  octomap::OcTree octree(0.1);
  ASSERT_TRUE(octree.readBinary(stream));
  EXPECT_DOUBLE_EQ(octree.getResolution(), 0.05);
  const octomap::OcTreeNode* free = octree.search(1.0, 0.0, 0.025);
  ASSERT_NE(free, nullptr);
  EXPECT_FALSE(octree.isNodeOccupied(free));

  const auto grid = planner::OccupancyGrid::fromTree(tree, kBounds);
  ASSERT_TRUE(grid);
  int occupied = 0;
  for (int row = 0; row < grid->rows(); ++row) {
    for (int column = 0; column < grid->columns(); ++column) {
      const Eigen::Vector2d at = grid->centreOf({column, row});
      const octomap::OcTreeNode* node = octree.search(at.x(), at.y(), 0.025);
      const bool is_occupied = node != nullptr && octree.isNodeOccupied(node);
      ASSERT_EQ(grid->occupied({column, row}), is_occupied) << at.transpose();
      occupied += is_occupied ? 1 : 0;
    }
  }
  EXPECT_GT(occupied, 500);

  // The file is what octovis opens.
  const test::ScratchFolder folder;
  ASSERT_TRUE(mapper_->save(folder.file("room.bt")));
  octomap::OcTree saved(0.1);
  ASSERT_TRUE(saved.readBinary(folder.file("room.bt")));
  EXPECT_TRUE(saved == octree);

  for (std::size_t size = 0; size < tree.size(); size += 997) {
    EXPECT_FALSE(planner::OccupancyGrid::fromTree(std::span(tree).first(size), kBounds)) << size;
  }
}

}  // namespace
}  // namespace roundabout::perception
