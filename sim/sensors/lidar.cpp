#include "sim/sensors/lidar.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace roundabout::sim {

namespace {

using Eigen::Vector2d;

// Of a side's length: no beam slips between two sides that share a corner.
constexpr double kCornerOverlap = 1e-9;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double angleStep(const config::Lidar& settings) {
  return settings.field_of_view_rad / (settings.beams - 1);
}

}  // namespace

Lidar::Lidar(const config::Lidar& settings) : settings_(settings) {
  for (int i = 0; i < settings.beams; ++i) {
    const double angle_rad = -settings.field_of_view_rad / 2.0 + i * angleStep(settings);
    cosines_.push_back(std::cos(angle_rad));
    sines_.push_back(std::sin(angle_rad));
  }
  origins_m_.assign(cosines_.size(), Vector2d::Zero());
  nearest_m_.resize(cosines_.size());
  ranges_m_.resize(cosines_.size());
}

core::RangeScan Lidar::sweep(const Vector2d& position_m, double heading_rad,
                             const Surfaces& surfaces, core::RandomStream* noise,
                             const SensorMotion& motion) {
  if (settings_.sweep_s > 0.0) {
    aim(heading_rad, motion);
  }
  std::fill(nearest_m_.begin(), nearest_m_.end(), settings_.max_range_m);
  const Eigen::Rotation2Dd to_sensor(-heading_rad);
  const auto seen = [&](const Vector2d& place_m) -> Vector2d {
    return to_sensor * (place_m - position_m);
  };
  for (const Disc& disc : surfaces.discs) {
    hitDisc(seen(disc.centre_m), disc.radius_m);
  }
  for (const core::Polygon& polygon : surfaces.polygons) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      hitSide(seen(polygon[i]), seen(polygon[(i + 1) % polygon.size()]));
    }
  }
  if (surfaces.walls != nullptr) {
    using Box = Eigen::AlignedBox2d;
    constexpr std::array kCorners = {Box::BottomLeft, Box::BottomRight, Box::TopRight,
                                     Box::TopLeft};
    for (std::size_t i = 0; i < kCorners.size(); ++i) {
      hitSide(seen(surfaces.walls->corner(kCorners[i])),
              seen(surfaces.walls->corner(kCorners[(i + 1) % kCorners.size()])));
    }
  }
  if (noise != nullptr && settings_.mixed_share > 0.0) {
    mixEdges(*noise);
  }
  if (noise != nullptr && settings_.noise_m > 0.0) {
    addNoise(*noise);
  }
  if (noise != nullptr && settings_.missed_share > 0.0) {
    miss(*noise);
  }
  std::transform(nearest_m_.begin(), nearest_m_.end(), ranges_m_.begin(),
                 [](double range_m) { return static_cast<float>(range_m); });
  return {-settings_.field_of_view_rad / 2.0, angleStep(settings_), settings_.max_range_m,
          ranges_m_};
}

/// Where each beam left from, and where it went.
void Lidar::aim(double heading_rad, const SensorMotion& motion) {
  const Vector2d velocity_mps = Eigen::Rotation2Dd(-heading_rad) * motion.velocity_mps;
  const auto last = static_cast<double>(cosines_.size() - 1);
  for (std::size_t i = 0; i < cosines_.size(); ++i) {
    const double earlier_s = settings_.sweep_s * (1.0 - static_cast<double>(i) / last);
    const double angle_rad = -settings_.field_of_view_rad / 2.0 +
                             static_cast<double>(i) * angleStep(settings_) -
                             motion.turn_rate_radps * earlier_s;
    cosines_[i] = std::cos(angle_rad);
    sines_[i] = std::sin(angle_rad);
    origins_m_[i] = -earlier_s * velocity_mps;
  }
}

/// centre: in the sensor's frame.
void Lidar::hitDisc(const Vector2d& centre, double radius_m) {
  const double gap_m = centre.norm() - radius_m;
  if (gap_m >= settings_.max_range_m) {
    return;
  }
  if (gap_m <= 0.0) {
    std::fill(nearest_m_.begin(), nearest_m_.end(), 0.0);
    return;
  }
  for (std::size_t i = 0; i < nearest_m_.size(); ++i) {
    const Vector2d apart = centre - origins_m_[i];
    const double along_m = cosines_[i] * apart.x() + sines_[i] * apart.y();
    const double aside_m = cosines_[i] * apart.y() - sines_[i] * apart.x();
    const double half_chord_squared = radius_m * radius_m - aside_m * aside_m;
    if (along_m > 0.0 && half_chord_squared >= 0.0) {
      nearest_m_[i] = std::min(nearest_m_[i], along_m - std::sqrt(half_chord_squared));
    }
  }
}

/// begin, end: in the sensor's frame.
void Lidar::hitSide(const Vector2d& begin, const Vector2d& end) {
  const Vector2d side = end - begin;
  for (std::size_t i = 0; i < nearest_m_.size(); ++i) {
    const Vector2d beam(cosines_[i], sines_[i]);
    const double slant = cross(beam, side);
    if (slant == 0.0) {
      continue;  // along the side: the next side's corner is hit
    }
    const Vector2d from = begin - origins_m_[i];
    const double range_m = cross(from, side) / slant;
    const double place = cross(from, beam) / slant;
    if (range_m >= 0.0 && place >= -kCornerOverlap && place <= 1.0 + kCornerOverlap) {
      nearest_m_[i] = std::min(nearest_m_[i], range_m);
    }
  }
}

/// A beam is wider than a point: at an edge a part of it hits each side.
void Lidar::mixEdges(core::RandomStream& noise) {
  constexpr double kEdge_m = 0.15;
  for (std::size_t i = 0; i + 1 < nearest_m_.size(); ++i) {
    const bool mixes = noise.chance(settings_.mixed_share);
    const double share = noise.uniform(0.0, 1.0);
    double& a = nearest_m_[i];
    const double b = nearest_m_[i + 1];
    const bool both_hit = a < settings_.max_range_m && b < settings_.max_range_m;
    if (mixes && both_hit && std::abs(a - b) > kEdge_m) {
      a += share * (b - a);
      ++i;  // the next one is past the edge
    }
  }
}

void Lidar::miss(core::RandomStream& noise) {
  for (double& range_m : nearest_m_) {
    range_m = noise.chance(settings_.missed_share) ? settings_.max_range_m : range_m;
  }
}

void Lidar::addNoise(core::RandomStream& noise) {
  for (double& range_m : nearest_m_) {
    // Drawn for every beam, so that what one beam hits changes no other one's error.
    const double error_m = noise.normal(settings_.noise_m);
    if (range_m < settings_.max_range_m) {
      range_m = std::clamp(range_m + error_m, 0.0, settings_.max_range_m);
    }
  }
}

}  // namespace roundabout::sim
