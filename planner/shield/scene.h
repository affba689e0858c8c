#pragma once

#include <array>
#include <limits>
#include <vector>

#include "planner/shield/shield.h"

namespace roundabout::planner::shield {

/// Another vehicle as the layers above the hard one see it: a disc that keeps its velocity.
struct Disc {
  Eigen::Vector2d relative_m;  ///< its centre, from that of the ego
  Eigen::Vector2d velocity_mps;
  double apart_m;  ///< sum of the radii, and the margin
  bool parked;
  bool gives_way;
  int id;
};

/// Unit vectors all round, the first along a direction, each next one to the right of the last.
inline constexpr std::size_t kFanDirections = 24;
std::array<Eigen::Vector2d, kFanDirections> fanFrom(const Eigen::Vector2d& direction);

/// The world round the ego now.
class Scene {
 public:
  void build(const Ego& ego, std::span<const Neighbour> neighbours,
             const ShieldParameters& parameters);

  const Eigen::Vector2d& position() const { return position_m_; }
  const Eigen::Vector2d& velocity() const { return velocity_mps_; }
  std::span<const Disc> discs() const { return discs_; }

  /// s until a velocity leads into a disc, at most `horizon_s`. An active disc makes half of the
  /// change (reciprocal velocity obstacle), a parked one none. Once it is found to be less than
  /// `enough_s` nothing earlier is looked for.
  double timeToCollision(const Eigen::Vector2d& velocity_mps, double horizon_s,
                         double enough_s = 0.0) const;
  /// The same with active discs alone.
  double timeToActive(const Eigen::Vector2d& velocity_mps, double horizon_s) const;

 private:
  Eigen::Vector2d position_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps_ = Eigen::Vector2d::Zero();
  std::vector<Disc> discs_;
};

/// s until a point that moves from the centre of a disc's frame enters it; infinite: never.
/// relative_m: the disc's centre; relative_mps: of the point.
double timeToDisc(const Eigen::Vector2d& relative_m, const Eigen::Vector2d& relative_mps,
                  double radius_m);

}  // namespace roundabout::planner::shield
