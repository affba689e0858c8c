#include "sim/sensors/depth_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace roundabout::sim {

namespace {

using Eigen::Vector2d;

constexpr double kNowhere = std::numeric_limits<double>::infinity();

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Where a ray from the origin meets a side, in lengths of the ray, behind the origin too;
/// infinite: nowhere. The end is no part of the side, so that a corner is met once.
double meeting(const Vector2d& ray, const Vector2d& begin, const Vector2d& end) {
  const double left_of_begin = cross(ray, begin);
  const double left_of_end = cross(ray, end);
  if ((left_of_begin < 0.0) == (left_of_end < 0.0)) {
    return kNowhere;
  }
  return cross(begin, end - begin) / cross(ray, end - begin);
}

/// The nearer side of a disc; infinite: it is missed, or the origin is in it.
double meeting(const Vector2d& ray, const Vector2d& centre, double radius_m) {
  const double along = ray.dot(centre) / ray.squaredNorm();
  const double half_squared = radius_m * radius_m - (centre - along * ray).squaredNorm();
  if (half_squared < 0.0 || centre.norm() <= radius_m) {
    return kNowhere;
  }
  const double depth_m = along - std::sqrt(half_squared / ray.squaredNorm());
  return depth_m > 0.0 ? depth_m : kNowhere;
}

}  // namespace

DepthCamera::DepthCamera(const config::Camera& settings)
    : settings_(settings),
      focal_px_(0.5 * settings.width / std::tan(0.5 * settings.field_of_view_rad)),
      depth_mm_(static_cast<std::size_t>(settings.width) *
                static_cast<std::size_t>(settings.height)) {}

std::span<const std::uint16_t> DepthCamera::render(const Vector2d& place_m, double heading_rad,
                                                   const DepthScene& scene,
                                                   core::RandomStream* noise) {
  // Camera frame: x ahead, y to the left.
  const Eigen::Isometry2d to_camera = Eigen::Rotation2Dd(-heading_rad - settings_.heading_rad) *
                                      Eigen::Translation2d(-place_m) *
                                      Eigen::Isometry2d::Identity();
  for (int column = 0; column < settings_.width; ++column) {
    look({1.0, (0.5 * settings_.width - column - 0.5) / focal_px_}, to_camera, scene);
    for (int row = 0; row < settings_.height; ++row) {
      const double up = (0.5 * settings_.height - row - 0.5) / focal_px_;
      depth_mm_[static_cast<std::size_t>(row * settings_.width + column)] =
          measured(depthAt(up), noise);
    }
  }
  return depth_mm_;
}

/// Collects what a column's ray meets.
void DepthCamera::look(const Vector2d& ray, const Eigen::Isometry2d& to_camera,
                       const DepthScene& scene) {
  using Box = Eigen::AlignedBox2d;
  constexpr Box::CornerType kCorners[] = {Box::BottomLeft, Box::BottomRight, Box::TopRight,
                                          Box::TopLeft};
  sides_.clear();
  faces_.clear();
  wall_m_ = kNowhere;
  for (std::size_t i = 0; i < std::size(kCorners); ++i) {
    const double depth_m = meeting(ray, to_camera * scene.walls.corner(kCorners[i]),
                                   to_camera * scene.walls.corner(kCorners[(i + 1) % 4]));
    wall_m_ = depth_m > 0.0 ? std::min(wall_m_, depth_m) : wall_m_;
  }
  for (const Cylinder& cylinder : scene.cylinders) {
    const double depth_m = meeting(ray, to_camera * cylinder.centre_m, cylinder.radius_m);
    if (depth_m < wall_m_) {
      sides_.push_back({depth_m, cylinder.bottom_m, cylinder.top_m});
    }
  }
  for (const Prism& prism : scene.prisms) {
    lookAt(ray, to_camera, prism);
  }
}

void DepthCamera::lookAt(const Vector2d& ray, const Eigen::Isometry2d& to_camera,
                         const Prism& prism) {
  cuts_.clear();
  for (std::size_t i = 0; i < prism.outline.size(); ++i) {
    const double depth_m = meeting(ray, to_camera * prism.outline[i],
                                   to_camera * prism.outline[(i + 1) % prism.outline.size()]);
    if (depth_m != kNowhere) {
      cuts_.push_back(depth_m);
    }
  }
  // A line goes into a polygon and out of it by turns.
  std::sort(cuts_.begin(), cuts_.end());
  for (std::size_t i = 0; i + 1 < cuts_.size(); i += 2) {
    for (const double depth_m : {cuts_[i], cuts_[i + 1]}) {
      if (depth_m > 0.0) {
        sides_.push_back({depth_m, prism.bottom_m, prism.top_m});
      }
    }
    for (const double height_m : {prism.bottom_m, prism.top_m}) {
      faces_.push_back({height_m, cuts_[i], cuts_[i + 1]});
    }
  }
}

/// Of the nearest thing that the column's ray meets when it rises by `up` a metre of depth.
double DepthCamera::depthAt(double up) const {
  const auto reaching = [&](double height_m) {
    const double depth_m = (height_m - settings_.height_m) / up;
    return depth_m > 0.0 ? depth_m : kNowhere;
  };
  double depth_m = std::min(wall_m_, reaching(0.0));
  for (const Side& side : sides_) {
    const double height_m = settings_.height_m + up * side.depth_m;
    if (side.depth_m < depth_m && height_m >= side.bottom_m && height_m <= side.top_m) {
      depth_m = side.depth_m;
    }
  }
  for (const Face& face : faces_) {
    const double face_m = reaching(face.height_m);
    if (face_m < depth_m && face_m >= face.begin_m && face_m <= face.end_m) {
      depth_m = face_m;
    }
  }
  return depth_m;
}

std::uint16_t DepthCamera::measured(double depth_m, core::RandomStream* noise) const {
  const config::DepthSensing& sensing = *settings_.depth;
  if (depth_m < sensing.nearest_m || depth_m > sensing.farthest_m) {
    return 0;
  }
  if (noise != nullptr && sensing.missed_share > 0.0 && noise->chance(sensing.missed_share)) {
    return 0;
  }
  if (noise != nullptr && sensing.noise_per_m > 0.0) {
    depth_m += noise->normal(sensing.noise_per_m * depth_m * depth_m);
  }
  return static_cast<std::uint16_t>(std::clamp(std::round(1000.0 * depth_m), 1.0, 65'535.0));
}

}  // namespace roundabout::sim
