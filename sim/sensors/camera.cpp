#include "sim/sensors/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace roundabout::sim {

namespace {

using Eigen::Vector2d;

constexpr double kWallHeightM = 2.6;
constexpr double kNearestM = 0.3;
constexpr double kFogM = 25.0;  // light falls to 1/e

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// A pattern that depends on the place alone, 0 to 1: surfaces have grain, and nothing is drawn by
// chance.
double grain(int a, int b) {
  auto hash =
      static_cast<std::uint32_t>(a) * 374761393U + static_cast<std::uint32_t>(b) * 668265263U;
  hash = (hash ^ (hash >> 13)) * 1274126177U;
  return static_cast<double>((hash ^ (hash >> 16)) & 0xFFU) / 255.0;
}

int cell(double metres, double size_m) { return static_cast<int>(std::floor(metres / size_m)); }

// From a to b, or from the end that is nearer.
double distanceToSegment(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double share = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (point - a - share * along).norm();
}

// A body in the plane of the image: x across, y up, in shares of its height; its limbs' places.
struct Figure {
  double left_foot;
  double right_foot;
  double swing;  // of the arms
  double half_shoulder;
};

enum class Part { kNothing, kHead, kHair, kTrunk, kArm, kLeg, kShoe };

Part partAt(const Vector2d& at, const Figure& figure) {
  constexpr double kHip = 0.50;
  constexpr double kShoulder = 0.82;
  const Vector2d head(0.0, 0.925);
  const Vector2d in_head((at.x() - head.x()) / 0.052, (at.y() - head.y()) / 0.070);
  if (in_head.norm() <= 1.0) {
    return in_head.y() > 0.35 ? Part::kHair : Part::kHead;
  }
  if (std::abs(at.x()) < 0.03 && at.y() > kShoulder && at.y() < head.y()) {
    return Part::kHead;
  }
  if (at.y() > kHip - 0.04 && at.y() <= kShoulder + 0.02) {
    const double share = (at.y() - kHip) / (kShoulder - kHip);
    const double half = figure.half_shoulder * (0.72 + 0.28 * std::clamp(share, 0.0, 1.0));
    const double round = at.y() > kShoulder - 0.02 ? 0.85 : 1.0;
    if (std::abs(at.x()) <= half * round) {
      return Part::kTrunk;
    }
  }
  for (const double side : {-1.0, 1.0}) {
    const Vector2d shoulder(side * figure.half_shoulder, kShoulder - 0.025);
    const Vector2d hand(side * (figure.half_shoulder + 0.02) - side * figure.swing, 0.46);
    if (distanceToSegment(at, shoulder, hand) < 0.028) {
      return Part::kArm;
    }
    const double foot = side < 0.0 ? figure.right_foot : figure.left_foot;
    const Vector2d hip(side * 0.045, kHip);
    const Vector2d ankle(foot, 0.04);
    const double thick = 0.030 + 0.018 * std::clamp(at.y() / kHip, 0.0, 1.0);
    if (distanceToSegment(at, hip, ankle) < thick && at.y() < kHip + 0.03) {
      return at.y() < 0.045 ? Part::kShoe : Part::kLeg;
    }
  }
  return Part::kNothing;
}

// Where a ray from the origin hits a side; infinite: nowhere. `along`: m from its beginning.
double hit(const Vector2d& ray, const Vector2d& begin, const Vector2d& end, double& along_m) {
  const Vector2d side = end - begin;
  const double slant = cross(ray, side);
  if (slant == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double range = cross(begin, side) / slant;
  const double share = cross(begin, ray) / slant;
  if (range <= 0.0 || share < 0.0 || share > 1.0) {
    return std::numeric_limits<double>::infinity();
  }
  along_m = share * side.norm();
  return range;
}

}  // namespace

CameraModel::CameraModel(const config::Camera& settings)
    : settings_(settings),
      focal_px_(0.5 * settings.width / std::tan(0.5 * settings.field_of_view_rad)),
      depth_m_(static_cast<std::size_t>(settings.width)),
      rgb_(static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height) *
           3) {}

std::span<const std::uint8_t> CameraModel::render(const Vector2d& place_m, double heading_rad,
                                                  const Stage& stage,
                                                  std::span<const Pedestrian> people,
                                                  double person_height_m) {
  const double axis_rad = heading_rad + settings_.heading_rad;
  drawStage(place_m, axis_rad, stage);
  // Camera frame: x ahead, y to the left. The farthest first.
  const Eigen::Rotation2Dd to_camera(-axis_rad);
  std::vector<std::pair<Vector2d, const Pedestrian*>> seen;
  for (const Pedestrian& person : people) {
    seen.emplace_back(to_camera * (person.position_m - place_m), &person);
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.first.x() > b.first.x(); });
  for (const auto& [at_m, person] : seen) {
    if (at_m.x() > kNearestM) {
      drawPerson(at_m, *person, axis_rad, person_height_m);
    }
  }
  return rgb_;
}

void CameraModel::set(int column, int row, const Colour& colour, double light) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(settings_.width) +
           static_cast<std::size_t>(column));
  const double values[] = {colour.red, colour.green, colour.blue};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb_[at + i] = static_cast<std::uint8_t>(std::clamp(255.0 * light * values[i], 0.0, 255.0));
  }
}

void CameraModel::drawStage(const Vector2d& place_m, double heading_rad, const Stage& stage) {
  constexpr Colour kWall{0.80, 0.78, 0.72};
  constexpr Colour kFurniture{0.62, 0.50, 0.38};
  constexpr Colour kFloor{0.55, 0.53, 0.50};
  constexpr Colour kCeiling{0.88, 0.88, 0.90};
  const Eigen::Rotation2Dd to_camera(-heading_rad);
  const Eigen::Rotation2Dd to_world(heading_rad);
  const auto seen = [&](const Vector2d& point_m) -> Vector2d {
    return to_camera * (point_m - place_m);
  };
  using Box = Eigen::AlignedBox2d;
  constexpr std::array kCorners = {Box::BottomLeft, Box::BottomRight, Box::TopRight, Box::TopLeft};
  for (int column = 0; column < settings_.width; ++column) {
    const Vector2d ray(1.0, (0.5 * settings_.width - column - 0.5) / focal_px_);
    double depth_m = std::numeric_limits<double>::infinity();
    double along_m = 0.0;
    bool furniture = false;
    const auto look = [&](const Vector2d& begin_m, const Vector2d& end_m, bool is_furniture) {
      double at_m = 0.0;
      const double range_m = hit(ray, seen(begin_m), seen(end_m), at_m);
      if (range_m < depth_m) {
        depth_m = range_m;
        along_m = at_m;
        furniture = is_furniture;
      }
    };
    for (std::size_t i = 0; i < kCorners.size(); ++i) {
      look(stage.walls.corner(kCorners[i]), stage.walls.corner(kCorners[(i + 1) % 4]), false);
    }
    for (const core::Polygon& obstacle : stage.obstacles) {
      for (std::size_t i = 0; i < obstacle.size(); ++i) {
        look(obstacle[i], obstacle[(i + 1) % obstacle.size()], true);
      }
    }
    depth_m_[static_cast<std::size_t>(column)] = depth_m;
    for (int row = 0; row < settings_.height; ++row) {
      const double up = (0.5 * settings_.height - row - 0.5) / focal_px_;
      const double wall_up_m = settings_.height_m + up * depth_m;
      if (wall_up_m >= 0.0 && wall_up_m < kWallHeightM) {
        const double shade = 0.94 + 0.06 * grain(cell(along_m, 0.3), cell(wall_up_m, 0.3));
        set(column, row, furniture ? kFurniture : kWall, shade * std::exp(-depth_m / kFogM));
        continue;
      }
      const double plane_m = up < 0.0 ? settings_.height_m : kWallHeightM - settings_.height_m;
      const double far_m = plane_m / std::max(std::abs(up), 1e-6);
      const Vector2d on_plane = place_m + to_world * (far_m * ray);
      const double shade = 0.92 + 0.08 * grain(cell(on_plane.x(), 0.4), cell(on_plane.y(), 0.4));
      set(column, row, up < 0.0 ? kFloor : kCeiling, shade * std::exp(-far_m / kFogM));
    }
  }
}

void CameraModel::drawPerson(const Vector2d& seen_m, const Pedestrian& person, double heading_rad,
                             double height_m) {
  static constexpr std::array<Colour, 6> kCoats = {{{0.55, 0.12, 0.12},
                                                    {0.10, 0.22, 0.45},
                                                    {0.12, 0.35, 0.18},
                                                    {0.20, 0.20, 0.22},
                                                    {0.45, 0.32, 0.10},
                                                    {0.35, 0.15, 0.40}}};
  constexpr Colour kSkin{0.85, 0.66, 0.55};
  constexpr Colour kHair{0.20, 0.14, 0.10};
  constexpr Colour kTrousers{0.14, 0.15, 0.22};
  constexpr Colour kShoes{0.08, 0.08, 0.08};
  const double depth_m = seen_m.x();
  const double scale_px = focal_px_ * height_m / depth_m;  // of the whole body
  const double middle_px = 0.5 * settings_.width - focal_px_ * seen_m.y() / depth_m;
  const double foot_px = 0.5 * settings_.height + focal_px_ * settings_.height_m / depth_m;

  // Across the image: to the right of the camera.
  const Vector2d right(std::sin(heading_rad), -std::cos(heading_rad));
  const auto legs_m = legsOf(person);
  const double facing = std::abs(std::cos(person.heading_rad - std::atan2(right.y(), right.x())));
  Figure figure{};
  figure.left_foot = (legs_m[0] - person.position_m).dot(right) / height_m;
  figure.right_foot = (legs_m[1] - person.position_m).dot(right) / height_m;
  if (figure.left_foot < figure.right_foot) {
    std::swap(figure.left_foot, figure.right_foot);
  }
  figure.swing = 0.5 * (figure.left_foot - figure.right_foot) * facing;
  figure.half_shoulder = 0.125 - 0.045 * facing;  // narrower from the side

  const auto first = [](double px) { return std::max(0, static_cast<int>(std::floor(px))); };
  const int last_column =
      std::min(settings_.width - 1, static_cast<int>(middle_px + 0.35 * scale_px));
  const int last_row = std::min(settings_.height - 1, static_cast<int>(foot_px));
  const Colour& coat = kCoats[static_cast<std::size_t>(person.id) % kCoats.size()];
  for (int column = first(middle_px - 0.35 * scale_px); column <= last_column; ++column) {
    if (depth_m_[static_cast<std::size_t>(column)] < depth_m) {
      continue;
    }
    for (int row = first(foot_px - scale_px); row <= last_row; ++row) {
      const Vector2d at((column + 0.5 - middle_px) / scale_px, (foot_px - row - 0.5) / scale_px);
      const Part part = partAt(at, figure);
      if (part == Part::kNothing) {
        continue;
      }
      const Colour& colour = part == Part::kHead   ? kSkin
                             : part == Part::kHair ? kHair
                             : part == Part::kLeg  ? kTrousers
                             : part == Part::kShoe ? kShoes
                                                   : coat;
      const double round = 1.0 - 1.6 * std::abs(at.x());
      const double cloth = part == Part::kArm ? 0.85 : 1.0;
      set(column, row, colour,
          round * cloth * (0.95 + 0.05 * grain(column, row)) * std::exp(-depth_m / kFogM));
    }
  }
}

}  // namespace roundabout::sim
