#include "perception/mapping/occupancy_mapper.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include <octomap/octomap.h>

namespace roundabout::perception {

namespace {

octomap::point3d pointOf(const Eigen::Vector2d& place_m, double height_m) {
  return {static_cast<float>(place_m.x()), static_cast<float>(place_m.y()),
          static_cast<float>(height_m)};
}

}  // namespace

MapUpdate mapUpdateOf(const AgentFinder& finder, double free_range_m) {
  const ScanPoints& points = finder.points();
  MapUpdate update;
  update.sensor_m = points.sensor_m;
  std::vector<bool> is_static(points.size(), false);
  for (const std::size_t beam : finder.staticBeams()) {
    is_static[beam] = true;
    update.hits_m.push_back(points.world_m[beam]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_static[i]) {
      const Eigen::Vector2d ray_m = points.world_m[i] - points.sensor_m;
      const double share = std::min(1.0, free_range_m / std::max(ray_m.norm(), 1e-9));
      update.free_m.push_back(points.sensor_m +
                              (points.hit[i] != 0 ? std::min(share, 0.98) : share) * ray_m);
    }
  }
  return update;
}

StaticCells::StaticCells(double resolution_m, std::vector<Eigen::Vector2d> centres_m,
                         std::vector<Eigen::Vector2d> depth_centres_m)
    : resolution_m_(resolution_m),
      centres_m_(std::move(centres_m)),
      depth_centres_m_(std::move(depth_centres_m)) {
  for (const Eigen::Vector2d& centre_m : centres_m_) {
    for (int right = -1; right <= 1; ++right) {
      for (int up = -1; up <= 1; ++up) {
        near_.insert(keyOf(centre_m, right, up));
      }
    }
  }
}

bool StaticCells::occupied(const Eigen::Vector2d& position_m) const {
  return near_.contains(keyOf(position_m, 0, 0));
}

std::int64_t StaticCells::keyOf(const Eigen::Vector2d& position_m, int right, int up) const {
  const auto column = static_cast<std::int64_t>(std::floor(position_m.x() / resolution_m_)) + right;
  const auto row = static_cast<std::int64_t>(std::floor(position_m.y() / resolution_m_)) + up;
  return column * (std::int64_t{1} << 32) + row;
}

/// The octree's layers, and what a sweep or picture says of each cell of its one: a grid is many
/// times faster than the hash sets of octomap's own insertion.
struct OccupancyMapper::Tree {
  enum Said : std::uint8_t { kNothing, kFree, kOccupied };

  Tree(double resolution_m, const Eigen::AlignedBox2d& bounds_m)
      : octree(resolution_m),
        height_m(resolution_m / 2.0),
        depth_height_m(1.5 * resolution_m),
        low(octree.coordToKey(pointOf(bounds_m.min(), height_m))) {
    const octomap::OcTreeKey high = octree.coordToKey(pointOf(bounds_m.max(), height_m));
    columns = high[0] - low[0] + 1;
    rows = high[1] - low[1] + 1;
    said.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), kNothing);
  }

  void say(const octomap::OcTreeKey& key, Said what) {
    const int column = key[0] - low[0];
    const int row = key[1] - low[1];
    if (column < 0 || column >= columns || row < 0 || row >= rows) {
      return;
    }
    std::uint8_t& cell = said[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                              static_cast<std::size_t>(column)];
    if (cell == kNothing) {
      touched.push_back(key);
    }
    cell = std::max<std::uint8_t>(cell, what);
  }

  Said take(const octomap::OcTreeKey& key) {
    const auto at = static_cast<std::size_t>(key[1] - low[1]) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(key[0] - low[0]);
    return static_cast<Said>(std::exchange(said[at], kNothing));
  }

  void learn() {
    constexpr bool kLazy = true;
    for (const octomap::OcTreeKey& key : touched) {
      octree.updateNode(key, take(key) == kOccupied, kLazy);
    }
    touched.clear();
  }

  octomap::OcTree octree;
  double height_m;        // of the layer of sweeps
  double depth_height_m;  // of the layer of depth pictures
  octomap::OcTreeKey low;
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> said;
  std::vector<octomap::OcTreeKey> touched;
};

OccupancyMapper::OccupancyMapper(double resolution_m, const Eigen::AlignedBox2d& bounds_m)
    : tree_(std::make_unique<Tree>(resolution_m, bounds_m)) {}

OccupancyMapper::~OccupancyMapper() = default;

void OccupancyMapper::insert(const MapUpdate& update) {
  octomap::OcTree& octree = tree_->octree;
  const octomap::point3d sensor = pointOf(update.sensor_m, tree_->height_m);
  octomap::KeyRay ray;
  const auto sayFree = [&](const octomap::point3d& end) {
    if (octree.computeRayKeys(sensor, end, ray)) {
      for (const octomap::OcTreeKey& key : ray) {
        tree_->say(key, Tree::kFree);
      }
    }
  };
  for (const Eigen::Vector2d& hit_m : update.hits_m) {
    const octomap::point3d hit = pointOf(hit_m, tree_->height_m);
    octomap::OcTreeKey key;
    sayFree(hit);
    if (octree.coordToKeyChecked(hit, key)) {
      tree_->say(key, Tree::kOccupied);
    }
  }
  for (const Eigen::Vector2d& end_m : update.free_m) {
    sayFree(pointOf(end_m, tree_->height_m));
  }
  tree_->learn();
}

void OccupancyMapper::insert(const DepthUpdate& update) {
  const auto say = [&](const std::vector<Eigen::Vector2d>& places_m, Tree::Said what) {
    for (const Eigen::Vector2d& place_m : places_m) {
      octomap::OcTreeKey key;
      if (tree_->octree.coordToKeyChecked(pointOf(place_m, tree_->depth_height_m), key)) {
        tree_->say(key, what);
      }
    }
  };
  say(update.free_m, Tree::kFree);
  say(update.hits_m, Tree::kOccupied);
  tree_->learn();
}

void OccupancyMapper::clear() { tree_->octree.clear(); }

std::shared_ptr<const StaticCells> OccupancyMapper::cells() const {
  const octomap::OcTree& octree = tree_->octree;
  std::vector<Eigen::Vector2d> centres_m;
  std::vector<Eigen::Vector2d> depth_centres_m;
  for (auto leaf = octree.begin_leafs(); leaf != octree.end_leafs(); ++leaf) {
    if (octree.isNodeOccupied(*leaf)) {
      const bool swept = leaf.getZ() < octree.getResolution();
      (swept ? centres_m : depth_centres_m).emplace_back(leaf.getX(), leaf.getY());
    }
  }
  return std::make_shared<StaticCells>(octree.getResolution(), std::move(centres_m),
                                       std::move(depth_centres_m));
}

std::vector<std::uint8_t> OccupancyMapper::binaryTree() {
  // Writing rounds every cell to free or occupied for good: a copy is written.
  octomap::OcTree copy(tree_->octree);
  copy.updateInnerOccupancy();
  copy.toMaxLikelihood();
  copy.prune();
  // As OcTree::writeBinary() does, which also writes to the standard error.
  std::ostringstream stream;
  stream << "# Octomap OcTree binary file\n"
            "# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
            "id "
         << copy.getTreeType() << "\nsize " << copy.size() << "\nres " << copy.getResolution()
         << "\ndata\n";
  if (copy.size() > 0) {
    copy.writeBinaryData(stream);
  }
  const std::string text = stream.str();
  return {text.begin(), text.end()};
}

bool OccupancyMapper::save(const std::string& path) {
  const std::vector<std::uint8_t> tree = binaryTree();
  const std::string unfinished = path + ".part";
  {
    std::ofstream file(unfinished, std::ios::binary);
    file.write(reinterpret_cast<const char*>(tree.data()),
               static_cast<std::streamsize>(tree.size()));
    if (!file.flush()) {
      return false;
    }
  }
  std::error_code error;
  std::filesystem::rename(unfinished, path, error);
  return !error;
}

}  // namespace roundabout::perception
