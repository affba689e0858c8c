#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace roundabout::planner {

/// The floor of a room in square cells: where something stands.
class OccupancyGrid {
 public:
  struct Cell {
    int column = 0;
    int row = 0;
    bool operator==(const Cell&) const = default;
  };

  /// Nothing stands anywhere. Outside the bounds nothing is known.
  OccupancyGrid(const Eigen::AlignedBox2d& bounds_m, double resolution_m);

  /// Reads the content of an OctoMap .bt file: cells in which the tree is occupied at any height
  /// are occupied; free and unknown ones are not. Nothing if it is no such tree, is cut off or too
  /// long, or has a resolution that no map of this room has; then *refusal, if asked for, says why.
  /// A reader of its own, since the planner does not link OctoMap (docs/perception.md).
  static std::optional<OccupancyGrid> fromTree(std::span<const std::uint8_t> tree,
                                               const Eigen::AlignedBox2d& bounds_m,
                                               const char** refusal = nullptr);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double resolution() const { return resolution_m_; }
  bool contains(const Cell& cell) const {
    return cell.column >= 0 && cell.column < columns_ && cell.row >= 0 && cell.row < rows_;
  }
  bool occupied(const Cell& cell) const { return cells_[indexOf(cell)] != 0; }
  Cell cellAt(const Eigen::Vector2d& place_m) const;
  Eigen::Vector2d centreOf(const Cell& cell) const;
  std::size_t indexOf(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(cell.column);
  }
  /// Marks every cell that a box touches.
  void occupy(const Eigen::AlignedBox2d& box_m);
  /// For each cell the distance to the nearest occupied one's centre, at most `most_m`.
  std::vector<float> clearance(double most_m) const;

 private:
  Eigen::Vector2d corner_m_;
  double resolution_m_;
  int columns_;
  int rows_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace roundabout::planner
