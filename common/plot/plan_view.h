#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/plot/canvas.h"

namespace roundabout::plot {

/// The floor seen from above, both axes to the same scale, big enough for all that was added.
class PlanView {
 public:
  /// Makes room for a circle. m, world.
  void include(const Eigen::Vector2d& centre, double radius_m);

  CanvasSize size() const;
  /// Axes, ranges and margins.
  void set(GnuplotScript& script, const std::string& caption) const;

 private:
  double pixelsPerMetre() const;
  Eigen::Vector2d extent() const;

  Eigen::Vector2d min_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m_ = Eigen::Vector2d::Zero();
  bool empty_ = true;
};

/// The outline of a five-pointed star.
std::vector<std::string> starRows(const Eigen::Vector2d& centre, double radius_m);

/// A polygon, drawn with kObstacleStyle.
std::vector<std::string> outlineRows(const std::vector<Eigen::Vector2d>& corners_m);
inline constexpr const char* kObstacleStyle =
    "with filledcurves closed fc rgb \"#9aa3ad\" fs solid border lc rgb \"#555555\" notitle";

}  // namespace roundabout::plot
