#include "planner/shield/way_round.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr int kSides = 10;
// A way may be this much nearer than a hindrance wants: its decagons touch that distance.
constexpr double kSlack_m = 1e-3;
constexpr double kNever = std::numeric_limits<double>::infinity();

double distanceOf(const Hindrance& hindrance, const Vector2d& a, const Vector2d& b) {
  const std::array<Vector2d, 2> segment{a, b};
  return gapBetween(segment, hindrance.corners_m).distance_m;
}

}  // namespace

double lengthOf(const Vector2d& from, const std::vector<Vector2d>& way) {
  double length_m = 0.0;
  Vector2d last = from;
  for (const Vector2d& place : way) {
    length_m += (place - last).norm();
    last = place;
  }
  return length_m;
}

bool WayRound::isFree(const Vector2d& from, const Vector2d& to,
                      std::span<const Hindrance> hindrances) {
  return std::all_of(hindrances.begin(), hindrances.end(), [&](const Hindrance& each) {
    return distanceOf(each, from, to) >= each.apart_m - kSlack_m;
  });
}

void WayRound::addDecagons(const Hindrance& hindrance) {
  const double out_m = hindrance.apart_m / std::cos(std::numbers::pi / kSides);
  for (const Vector2d& corner : hindrance.corners_m) {
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSides;
      corners_.emplace_back(corner + out_m * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
}

// Dijkstra's. Edges are checked only once they are needed.
bool WayRound::search(const Vector2d& from, const Vector2d& to) {
  nodes_.clear();
  nodes_.push_back({from, 0.0, -1, false});
  nodes_.push_back({to, kNever, -1, false});
  for (const Vector2d& corner : corners_) {
    if (isFree(corner, corner, chosen_)) {
      nodes_.push_back({corner, kNever, -1, false});
    }
  }
  for (;;) {
    int best = -1;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!nodes_[i].settled && nodes_[i].cost_m < kNever &&
          (best < 0 || nodes_[i].cost_m < nodes_[static_cast<std::size_t>(best)].cost_m)) {
        best = static_cast<int>(i);
      }
    }
    if (best < 0) {
      return false;
    }
    Node& node = nodes_[static_cast<std::size_t>(best)];
    node.settled = true;
    if (best == 1) {
      return true;
    }
    for (Node& next : nodes_) {
      const double cost_m = node.cost_m + (next.place - node.place).norm();
      if (!next.settled && cost_m < next.cost_m && isFree(node.place, next.place, chosen_)) {
        next.cost_m = cost_m;
        next.before = best;
      }
    }
  }
}

bool WayRound::addBlocking(const std::vector<Vector2d>& way) {
  bool added = false;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    for (std::size_t k = 1; k < way.size() && !used_[i]; ++k) {
      if (distanceOf(all_[i], way[k - 1], way[k]) < all_[i].apart_m - kSlack_m) {
        used_[i] = true;
        chosen_.push_back(all_[i]);
        addDecagons(all_[i]);
        added = true;
      }
    }
  }
  return added;
}

std::optional<std::vector<Vector2d>> WayRound::find(const Vector2d& from, const Vector2d& to,
                                                    std::span<const Hindrance> hindrances) {
  all_.assign(hindrances.begin(), hindrances.end());
  for (Hindrance& each : all_) {
    each.apart_m = std::max(
        0.0, std::min({each.apart_m, distanceOf(each, from, from), distanceOf(each, to, to)}));
  }
  used_.assign(all_.size(), false);
  chosen_.clear();
  corners_.clear();
  std::vector<Vector2d> way{from, to};
  while (addBlocking(way)) {
    if (!search(from, to)) {
      return std::nullopt;
    }
    way.clear();
    for (int i = 1; i >= 0; i = nodes_[static_cast<std::size_t>(i)].before) {
      way.push_back(nodes_[static_cast<std::size_t>(i)].place);
    }
    std::reverse(way.begin(), way.end());
  }
  way.erase(way.begin());
  return way;
}

}  // namespace roundabout::planner::shield
