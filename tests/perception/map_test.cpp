// The map as perception makes it, as OctoMap reads it, and as the planner reads it.

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include "common/core/polygon.h"
#include "common/core/random.h"
#include "perception/clustering/table.h"
#include "perception/mapping/occupancy_mapper.h"
#include "planner/map/occupancy_grid.h"
#include "sim/sensors/depth_camera.h"
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

/// A robot's depth camera among a box 15 cm high, which a lidar at 30 cm does not see, a shelf that
/// hangs at 40 cm, and a lamp above everybody, in a room with walls.
class DepthMap : public ::testing::Test {
 protected:
  static constexpr HeightBand kBand{0.06, 0.8};
  static constexpr double kCell_m = 0.05;

  DepthMap() {
    camera_.width = 160;
    camera_.height = 120;
    camera_.heading_rad = 0.3;
    camera_.depth = config::DepthSensing{0.3, 4.0, 0.0, 0.0};
  }

  static sim::Prism prism(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m,
                          double bottom_m, double top_m) {
    return {{low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}}, bottom_m, top_m};
  }

  DepthView viewFrom(const PlanarPose& pose, core::RandomStream* noise = nullptr) const {
    sim::DepthCamera camera(camera_);
    const auto depths =
        camera.render(pose.position_m, pose.heading_rad, {things_, people_, room_}, noise);
    return {{0, camera_.width, camera_.height, {depths.begin(), depths.end()}}, camera_, pose, {}};
  }

  /// From its outline, or a wall; negative: inside it.
  static double distanceTo(const sim::Prism& thing, const Eigen::Vector2d& place_m) {
    return core::distanceTo(thing.outline, place_m);
  }

  const sim::Prism box_ = prism({1.5, -0.3}, {1.9, 0.4}, 0.0, 0.15);
  const sim::Prism shelf_ = prism({0.5, 1.5}, {1.5, 1.9}, 0.4, 0.45);
  const sim::Prism lamp_ = prism({-1.5, -1.5}, {-1.0, 1.5}, 0.9, 1.2);
  std::vector<sim::Prism> things_{box_, shelf_, lamp_};
  std::vector<sim::Cylinder> people_;
  const Eigen::AlignedBox2d room_{Eigen::Vector2d(-3, -3), Eigen::Vector2d(3, 3)};
  config::Camera camera_;
};

TEST_F(DepthMap, PicturesHitWhatStandsInTheWayAndNothingElse) {
  core::RandomStream random(3, "poses");
  bool seen_box = false;
  bool seen_shelf = false;
  for (int i = 0; i < 60; ++i) {
    const PlanarPose pose{{random.uniform(-0.9, 1.2), random.uniform(-1.5, 1.2)},
                          random.uniform(-3.0, 3.0)};
    const DepthUpdate update = depthUpdateOf(viewFrom(pose), kBand, kCell_m);
    for (const Eigen::Vector2d& hit_m : update.hits_m) {
      const bool of_box = distanceTo(box_, hit_m) < kCell_m;
      const bool of_shelf = distanceTo(shelf_, hit_m) < kCell_m;
      const bool of_wall = hit_m.cwiseAbs().maxCoeff() > 3.0 - kCell_m;
      ASSERT_TRUE(of_box || of_shelf || of_wall) << hit_m.transpose();
      seen_box = seen_box || of_box;
      seen_shelf = seen_shelf || of_shelf;
    }
    for (const Eigen::Vector2d& free_m : update.free_m) {
      ASSERT_GT(distanceTo(box_, free_m), 0.0) << free_m.transpose();
      ASSERT_GT(distanceTo(shelf_, free_m), 0.0) << free_m.transpose();
      ASSERT_LT(free_m.cwiseAbs().maxCoeff(), 3.0) << free_m.transpose();
    }
  }
  EXPECT_TRUE(seen_box);
  EXPECT_TRUE(seen_shelf);
}

TEST_F(DepthMap, IsFreeOnlyWhereTheWholeBandIsSeen) {
  camera_.heading_rad = 0.0;
  const DepthUpdate update = depthUpdateOf(viewFrom({{0.0, 0.0}, 0.0}), kBand, kCell_m);
  const double steepest = 59.5 / (80.0 / std::tan(0.6));
  double nearest_m = 10.0;
  bool past_the_box = false;
  for (const Eigen::Vector2d& free_m : update.free_m) {
    nearest_m = std::min(nearest_m, free_m.x());
    past_the_box = past_the_box || (free_m.x() > 2.1 && std::abs(free_m.y()) < 0.2);
    // The ray to the lowest height of a place passes the box's far edge above it.
    if (std::abs(free_m.y()) < 0.15 * free_m.x() && free_m.x() > 1.9) {
      const double height_m = 0.5 - (0.5 - kBand.lowest_m) * 1.9 / free_m.x();
      ASSERT_GT(height_m, 0.15) << free_m.transpose();
    }
  }
  // Nearer the picture's lower edge is above the band's.
  EXPECT_NEAR(nearest_m, (0.5 - kBand.lowest_m) / steepest, 1.5 * kCell_m);
  EXPECT_TRUE(past_the_box);
}

TEST_F(DepthMap, AgentsAreKeptOut) {
  people_ = {{{1.0, 0.0}, 0.2, 0.0, 1.7}};
  DepthView view = viewFrom({{0.0, 0.0}, -0.3});
  const auto nearest = [&] {
    double nearest_m = 10.0;
    for (const Eigen::Vector2d& hit_m : depthUpdateOf(view, kBand, kCell_m).hits_m) {
      nearest_m = std::min(nearest_m, hit_m.norm());
    }
    return nearest_m;
  };
  EXPECT_NEAR(nearest(), 0.8, kCell_m);
  view.agents = {{{1.0, 0.0}, 0.4}};
  EXPECT_GT(nearest(), 1.4);
  for (const Eigen::Vector2d& free_m : depthUpdateOf(view, kBand, kCell_m).free_m) {
    EXPECT_FALSE(free_m.x() > 0.85 && std::abs(free_m.y()) < 0.15 * free_m.x());
  }
}

TEST_F(DepthMap, KeepsThePlannerOffWhatSweepsPassOver) {
  camera_.depth = config::DepthSensing{0.3, 4.0, 0.0025, 0.05};
  OccupancyMapper mapper(kCell_m, kBounds);
  core::RandomStream noise(5, "depth");
  const MapUpdate sweep{{0.0, 0.0}, {}, {{3.0, 0.0}, {3.0, 0.1}, {3.0, -0.1}}};
  const auto grid = [&] { return planner::OccupancyGrid::fromTree(mapper.binaryTree(), kBounds); };
  const auto isOccupied = [&](double x_m, double y_m) {
    const auto read = grid();
    return read && read->occupied(read->cellAt({x_m, y_m}));
  };
  const auto look = [&](int pictures) {
    for (int i = 0; i < pictures; ++i) {
      mapper.insert(depthUpdateOf(viewFrom({{0.0, 0.0}, -0.3}, &noise), kBand, kCell_m));
      mapper.insert(sweep);
    }
  };
  look(10);
  EXPECT_TRUE(isOccupied(1.52, 0.02)) << "the lidar, which sees over it, clears its own layer";
  EXPECT_FALSE(isOccupied(1.2, 0.02));
  EXPECT_FALSE(isOccupied(2.7, 0.02));
  // What no sweep hit is no piece of furniture for the tracks: who stands there is somebody.
  EXPECT_FALSE(mapper.cells()->occupied({1.52, 0.02}));
  EXPECT_GT(mapper.cells()->depthCentres().size(), 20U);

  things_.clear();
  look(10);
  EXPECT_FALSE(isOccupied(1.52, 0.02)) << "it was carried away";
}

}  // namespace
}  // namespace roundabout::perception
