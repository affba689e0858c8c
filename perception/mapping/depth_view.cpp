#include "perception/mapping/depth_view.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace roundabout::perception {

namespace {

using Eigen::Vector2d;

constexpr std::ptrdiff_t kLeastPixels = 2;  // alone it may be an error
constexpr double kLeastMeasured = 0.2;
constexpr double kDeviations = 3.0;

/// A picture and the pinhole that took it. Rows count from the top.
class Pinhole {
 public:
  explicit Pinhole(const DepthView& view)
      : view_(view),
        focal_px_(0.5 * view.camera.width / std::tan(0.5 * view.camera.field_of_view_rad)) {
    const double axis_rad = view.vehicle.heading_rad + view.camera.heading_rad;
    ahead_ = {std::cos(axis_rad), std::sin(axis_rad)};
    left_ = {-ahead_.y(), ahead_.x()};
  }

  /// Of the floor, below what a column sees at a depth. World.
  Vector2d placeAt(int column, double depth_m) const {
    const double left = (0.5 * view_.camera.width - column - 0.5) / focal_px_;
    return view_.vehicle.position_m + depth_m * (ahead_ + left * left_);
  }
  double heightAt(int row, double depth_m) const {
    return view_.camera.height_m + depth_m * (0.5 * view_.camera.height - row - 0.5) / focal_px_;
  }
  /// The row, and share of one, that sees a height at a depth.
  double rowOf(double height_m, double depth_m) const {
    return 0.5 * view_.camera.height - 0.5 -
           focal_px_ * (height_m - view_.camera.height_m) / depth_m;
  }
  /// 0: nothing was measured, or nothing that this camera can measure.
  double depthAt(int column, int row) const {
    const double depth_m =
        0.001 * view_.image.depth_mm[static_cast<std::size_t>(row * view_.image.width + column)];
    const config::DepthSensing& sensing = *view_.camera.depth;
    return depth_m >= sensing.nearest_m && depth_m <= sensing.farthest_m ? depth_m : 0.0;
  }

 private:
  const DepthView& view_;
  double focal_px_;
  Vector2d ahead_;
  Vector2d left_;
};

bool isKeptOut(const std::vector<KeptOut>& agents, const Vector2d& place_m) {
  return std::any_of(agents.begin(), agents.end(), [&](const KeptOut& agent) {
    return (place_m - agent.centre_m).squaredNorm() < agent.radius_m * agent.radius_m;
  });
}

struct CellKey {
  std::int32_t column;
  std::int32_t row;
  auto operator<=>(const CellKey&) const = default;
};

std::vector<Vector2d> hitsOf(const DepthView& view, const Pinhole& pinhole, const HeightBand& band,
                             double cell_m) {
  std::vector<CellKey> cells;
  for (int row = 0; row < view.image.height; ++row) {
    for (int column = 0; column < view.image.width; ++column) {
      const double depth_m = pinhole.depthAt(column, row);
      const double height_m = pinhole.heightAt(row, depth_m);
      if (depth_m == 0.0 || height_m < band.lowest_m || height_m > band.highest_m) {
        continue;
      }
      const Vector2d place_m = pinhole.placeAt(column, depth_m);
      if (!isKeptOut(view.agents, place_m)) {
        cells.push_back({static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
                         static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))});
      }
    }
  }
  std::sort(cells.begin(), cells.end());
  std::vector<Vector2d> hits_m;
  for (auto begin = cells.begin(); begin != cells.end();) {
    const auto end = std::upper_bound(begin, cells.end(), *begin);
    if (end - begin >= kLeastPixels) {
      hits_m.emplace_back(cell_m * (begin->column + 0.5), cell_m * (begin->row + 0.5));
    }
    begin = end;
  }
  return hits_m;
}

/// Whether a column sees the whole band at a depth, and past it.
bool seesPast(const DepthView& view, const Pinhole& pinhole, const HeightBand& band, int column,
              double depth_m, double margin_m) {
  const double top = pinhole.rowOf(band.highest_m, depth_m);
  const double bottom = pinhole.rowOf(band.lowest_m, depth_m);
  if (top < 0.0 || bottom > view.image.height - 1) {
    return false;
  }
  const int first = static_cast<int>(std::floor(top));
  const int last = static_cast<int>(std::ceil(bottom));
  int measured = 0;
  for (int row = first; row <= last; ++row) {
    const double seen_m = pinhole.depthAt(column, row);
    if (seen_m > 0.0 && seen_m <= depth_m + margin_m) {
      return false;
    }
    measured += seen_m > 0.0 ? 1 : 0;
  }
  return measured > 0 && measured >= kLeastMeasured * (last - first + 1);
}

}  // namespace

DepthUpdate depthUpdateOf(const DepthView& view, const HeightBand& band, double cell_m) {
  const Pinhole pinhole(view);
  const config::DepthSensing& sensing = *view.camera.depth;
  DepthUpdate update;
  update.hits_m = hitsOf(view, pinhole, band, cell_m);
  for (double depth_m = sensing.nearest_m + cell_m; depth_m < sensing.farthest_m;
       depth_m += cell_m) {
    const double margin_m = std::max(cell_m, kDeviations * sensing.noise_per_m * depth_m * depth_m);
    for (int column = 0; column < view.image.width; ++column) {
      if (seesPast(view, pinhole, band, column, depth_m, margin_m)) {
        update.free_m.push_back(pinhole.placeAt(column, depth_m));
      }
    }
  }
  return update;
}

}  // namespace roundabout::perception
