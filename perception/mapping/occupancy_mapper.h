#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "perception/agent_finder.h"
#include "perception/mapping/depth_view.h"

namespace roundabout::perception {

/// What one sweep says of the static world. World frame.
struct MapUpdate {
  Eigen::Vector2d sensor_m = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> hits_m;  ///< something that does not move is here
  std::vector<Eigen::Vector2d> free_m;  ///< nothing is between the sensor and here
};

/// Hits on what does not move, and free space up to everything else: agents, their legs, and where
/// beams ended without an echo, but there only up to `free_range_m`.
MapUpdate mapUpdateOf(const AgentFinder& finder, double free_range_m);

/// The cells that are occupied, frozen: those that sweeps hit, and those that depth pictures did.
class StaticCells final : public StaticWorld {
 public:
  StaticCells(double resolution_m, std::vector<Eigen::Vector2d> centres_m,
              std::vector<Eigen::Vector2d> depth_centres_m = {});
  /// In a cell that sweeps hit, or in a neighbour of one: who stands where pictures alone saw
  /// something is somebody.
  bool occupied(const Eigen::Vector2d& position_m) const override;
  const std::vector<Eigen::Vector2d>& centres() const { return centres_m_; }
  const std::vector<Eigen::Vector2d>& depthCentres() const { return depth_centres_m_; }

 private:
  std::int64_t keyOf(const Eigen::Vector2d& position_m, int right, int up) const;

  double resolution_m_;
  std::vector<Eigen::Vector2d> centres_m_;
  std::vector<Eigen::Vector2d> depth_centres_m_;
  std::unordered_set<std::int64_t> near_;
};

/// The static world as an OctoMap (Hornung et al., Autonomous Robots 2013). Two layers of cells, of
/// which neither clears the other's: on the floor what sweeps say of the lidar's plane, above it
/// what depth pictures say of all heights in their band.
class OccupancyMapper {
 public:
  /// bounds: nothing outside is mapped.
  OccupancyMapper(double resolution_m, const Eigen::AlignedBox2d& bounds_m);
  ~OccupancyMapper();

  void insert(const MapUpdate& update);
  void insert(const DepthUpdate& update);
  void clear();
  std::shared_ptr<const StaticCells> cells() const;
  /// The content of a .bt file: the most probable of free and occupied.
  std::vector<std::uint8_t> binaryTree();
  /// Writes a .bt file for octovis, whole or not at all. Returns false if it cannot be written.
  bool save(const std::string& path);

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace roundabout::perception
