#include "planner/map/way_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "common/core/polygon.h"

namespace roundabout::planner {

namespace {

// Farther than it must be from walls a body goes where that costs little.
constexpr double kComfort_m = 0.3;
constexpr double kDiscomfort = 2.0;  // times as long as the same way in the open
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kDirection_rad = std::numbers::pi / 12.0;
constexpr int kDirections = 6;  // to each side: up to a right angle
constexpr std::size_t kSectors = 12;
constexpr std::size_t kRaysPerSector = 10;

struct Step {
  int column;
  int row;
  double length;  // in cells
};
constexpr std::array kSteps = {Step{1, 0, 1.0},
                               Step{-1, 0, 1.0},
                               Step{0, 1, 1.0},
                               Step{0, -1, 1.0},
                               Step{1, 1, std::numbers::sqrt2},
                               Step{1, -1, std::numbers::sqrt2},
                               Step{-1, 1, std::numbers::sqrt2},
                               Step{-1, -1, std::numbers::sqrt2}};

double octile(const OccupancyGrid::Cell& a, const OccupancyGrid::Cell& b) {
  const double right = std::abs(a.column - b.column);
  const double up = std::abs(a.row - b.row);
  return std::max(right, up) + (std::numbers::sqrt2 - 1.0) * std::min(right, up);
}

}  // namespace

WayFinder::WayFinder(const Settings& settings, OccupancyGrid grid)
    : keep_m_(settings.body_radius_m + settings.margin_m + grid.resolution() / 2.0),
      comfort_m_(keep_m_ + kComfort_m),
      grid_(std::move(grid)),
      clearance_m_(grid_.clearance(comfort_m_)) {}

double WayFinder::clearanceAt(const Eigen::Vector2d& place_m) const {
  const OccupancyGrid::Cell cell = grid_.cellAt(place_m);
  return grid_.contains(cell) ? clearance_m_[grid_.indexOf(cell)] : comfort_m_;
}

bool WayFinder::freeBetween(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const {
  const int steps =
      std::max(1, static_cast<int>(std::ceil((to_m - from_m).norm() / grid_.resolution())));
  double least_m = std::min(clearanceAt(from_m), keep_m_);
  for (int i = 1; i <= steps; ++i) {
    const double here_m = clearanceAt(from_m + (to_m - from_m) * i / steps);
    if (here_m < least_m) {
      return false;
    }
    // Who has come away from a wall does not come back.
    least_m = std::min(std::max(least_m, here_m), keep_m_);
  }
  return true;
}

std::optional<WayFinder::Leg> WayFinder::nextLeg(const Eigen::Vector2d& from_m,
                                                 const Eigen::Vector2d& goal_m) const {
  if (freeBetween(from_m, goal_m)) {
    return Leg{goal_m, (goal_m - from_m).norm()};
  }
  const std::vector<Eigen::Vector2d> places = way(from_m, goal_m);
  if (places.empty()) {
    return std::nullopt;
  }
  Leg leg{places[std::min<std::size_t>(1, places.size() - 1)], (places.front() - from_m).norm()};
  for (std::size_t i = 1; i < places.size(); ++i) {
    leg.way_left_m += (places[i] - places[i - 1]).norm();
  }
  for (const Eigen::Vector2d& place_m : places) {
    if (!freeBetween(from_m, place_m)) {
      break;
    }
    leg.place_m = place_m;
  }
  return leg;
}

/// Of a cell's length; infinite: not to be entered.
double WayFinder::costOf(const OccupancyGrid::Cell& cell, double start_clearance_m) const {
  const double here_m = clearance_m_[grid_.indexOf(cell)];
  if (here_m < std::min(keep_m_, start_clearance_m)) {
    return kInfinite;
  }
  const double share = std::clamp((comfort_m_ - here_m) / (comfort_m_ - keep_m_), 0.0, 1.0);
  return 1.0 + kDiscomfort * share;
}

std::vector<Eigen::Vector2d> WayFinder::way(const Eigen::Vector2d& from_m,
                                            const Eigen::Vector2d& goal_m) const {
  const OccupancyGrid::Cell start = grid_.cellAt(from_m);
  const OccupancyGrid::Cell goal = grid_.cellAt(goal_m);
  if (!grid_.contains(start) || !grid_.contains(goal)) {
    return {};
  }
  const double start_clearance_m = clearanceAt(from_m);
  const std::size_t cells = clearance_m_.size();
  std::vector<double> cost(cells, kInfinite);
  std::vector<std::int32_t> previous(cells, -1);
  using Open = std::pair<double, std::size_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const auto cellOf = [&](std::size_t index) {
    return OccupancyGrid::Cell{static_cast<int>(index % static_cast<std::size_t>(grid_.columns())),
                               static_cast<int>(index / static_cast<std::size_t>(grid_.columns()))};
  };
  cost[grid_.indexOf(start)] = 0.0;
  open.emplace(octile(start, goal), grid_.indexOf(start));
  while (!open.empty()) {
    const auto [estimate, index] = open.top();
    open.pop();
    const OccupancyGrid::Cell cell = cellOf(index);
    if (cell == goal) {
      break;
    }
    if (estimate > cost[index] + octile(cell, goal) + 1e-9) {
      continue;  // reached more cheaply since
    }
    for (const Step& step : kSteps) {
      const OccupancyGrid::Cell next{cell.column + step.column, cell.row + step.row};
      if (!grid_.contains(next)) {
        continue;
      }
      const double through = cost[index] + step.length * costOf(next, start_clearance_m);
      const std::size_t next_index = grid_.indexOf(next);
      if (through < cost[next_index]) {
        cost[next_index] = through;
        previous[next_index] = static_cast<std::int32_t>(index);
        open.emplace(through + octile(next, goal), next_index);
      }
    }
  }
  if (cost[grid_.indexOf(goal)] == kInfinite) {
    return {};
  }
  std::vector<Eigen::Vector2d> places{goal_m};
  for (std::int32_t at = previous[grid_.indexOf(goal)]; at >= 0;
       at = previous[static_cast<std::size_t>(at)]) {
    places.push_back(grid_.centreOf(cellOf(static_cast<std::size_t>(at))));
  }
  std::reverse(places.begin(), places.end());
  return places;
}

Eigen::Vector2d WayFinder::maskedVelocity(const Eigen::Vector2d& from_m,
                                          const Eigen::Vector2d& velocity_mps,
                                          double look_ahead_s) const {
  const auto isFree = [&](const Eigen::Vector2d& candidate_mps) {
    return freeBetween(from_m, from_m + look_ahead_s * candidate_mps);
  };
  for (const double share : {1.0, 0.5}) {
    for (int turn = 0; turn <= kDirections; ++turn) {
      for (const double side : {1.0, -1.0}) {
        const Eigen::Vector2d candidate_mps =
            share * (Eigen::Rotation2Dd(side * turn * kDirection_rad) * velocity_mps);
        if (isFree(candidate_mps)) {
          return candidate_mps;
        }
      }
    }
  }
  return Eigen::Vector2d::Zero();
}

void WayFinder::nearestCells(const Eigen::Vector2d& place_m, double reach_m,
                             std::vector<core::Polygon>& cells) const {
  struct Nearest {
    double distance_m2;
    OccupancyGrid::Cell cell;
  };
  std::array<Nearest, kSectors * kRaysPerSector> nearest;
  nearest.fill({reach_m * reach_m, {}});
  const OccupancyGrid::Cell low = grid_.cellAt(place_m - Eigen::Vector2d::Constant(reach_m));
  const OccupancyGrid::Cell high = grid_.cellAt(place_m + Eigen::Vector2d::Constant(reach_m));
  for (int row = std::max(low.row, 0); row <= std::min(high.row, grid_.rows() - 1); ++row) {
    for (int column = std::max(low.column, 0); column <= std::min(high.column, grid_.columns() - 1);
         ++column) {
      if (!grid_.occupied({column, row})) {
        continue;
      }
      const Eigen::Vector2d way = grid_.centreOf({column, row}) - place_m;
      const double turns = std::atan2(way.y(), way.x()) / (2.0 * std::numbers::pi) + 0.5;
      const auto ray = static_cast<std::size_t>(turns * static_cast<double>(nearest.size()));
      Nearest& of_ray = nearest[std::min(ray, nearest.size() - 1)];
      if (way.squaredNorm() < of_ray.distance_m2) {
        of_ray = {way.squaredNorm(), {column, row}};
      }
    }
  }
  cells.clear();
  const double half_m = grid_.resolution() / 2.0;
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    core::Polygon corners;
    for (std::size_t ray = 0; ray < kRaysPerSector; ++ray) {
      const Nearest& each = nearest[sector * kRaysPerSector + ray];
      if (each.distance_m2 < reach_m * reach_m) {
        const Eigen::Vector2d centre = grid_.centreOf(each.cell);
        for (const double x : {-half_m, half_m}) {
          for (const double y : {-half_m, half_m}) {
            corners.push_back(centre + Eigen::Vector2d(x, y));
          }
        }
      }
    }
    if (!corners.empty()) {
      cells.push_back(core::convexHull(std::move(corners)));
    }
  }
}

}  // namespace roundabout::planner
