#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "common/core/random.h"

namespace roundabout::sim {

/// A body as a planar lidar sees it. World frame.
struct Disc {
  Eigen::Vector2d centre_m;
  double radius_m;
};

/// What a sweep may hit.
struct Surfaces {
  std::span<const Disc> discs{};               ///< solid: from within one every range is 0
  std::span<const core::Polygon> polygons{};   ///< their sides, seen from both
  const Eigen::AlignedBox2d* walls = nullptr;  ///< its sides, seen from both; nothing: no walls
};

/// How a sensor moves during a sweep.
struct SensorMotion {
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();  ///< world
  double turn_rate_radps = 0.0;
};

/// A planar range finder: beams at equal angles, the first and the last at the edges of a field of
/// view that is centred on the sensor's heading. Deterministic; allocates nothing after it is made.
class Lidar {
 public:
  explicit Lidar(const config::Lidar& settings);

  /// Ranges to the nearest surface, at most the maximum range; valid until the next call. With a
  /// `noise` whatever is hit gets a normal error of settings.noise_m; a share of it is missed; and
  /// a share of the beams at an edge in depth say something between the two sides. Place and
  /// heading are those of the last beam; with settings.sweep_s the beams before it left earlier on
  /// the way of `motion`. Surfaces stand still.
  core::RangeScan sweep(const Eigen::Vector2d& position_m, double heading_rad,
                        const Surfaces& surfaces, core::RandomStream* noise = nullptr,
                        const SensorMotion& motion = {});

  const config::Lidar& settings() const { return settings_; }

 private:
  void hitDisc(const Eigen::Vector2d& centre, double radius_m);
  void hitSide(const Eigen::Vector2d& begin, const Eigen::Vector2d& end);
  void aim(double heading_rad, const SensorMotion& motion);
  void mixEdges(core::RandomStream& noise);
  void addNoise(core::RandomStream& noise);
  void miss(core::RandomStream& noise);

  config::Lidar settings_;
  // Of the beams, in the sensor's frame at the last one.
  std::vector<double> cosines_;
  std::vector<double> sines_;
  std::vector<Eigen::Vector2d> origins_m_;
  std::vector<double> nearest_m_;
  std::vector<float> ranges_m_;
};

}  // namespace roundabout::sim
