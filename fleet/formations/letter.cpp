#include "fleet/formations/letter.h"

#include <limits>

#include <spdlog/fmt/fmt.h>

#include "common/config/spacing.h"
#include "fleet/formations/spread.h"
#include "fleet/goal_check.h"

namespace roundabout::fleet {

namespace {

// The smallest scale that keeps the points apart, and the points in units of the font.
struct Layout {
  std::vector<Eigen::Vector2d> points;
  double scale_m;
};

Layout layOut(const std::vector<Stroke>& strokes, std::size_t count, double height_m,
              double spacing_m) {
  const auto scaleFor = [&](const std::vector<Eigen::Vector2d>& points) {
    return std::max(height_m, spacing_m / closestPair(points));
  };
  const std::vector<Eigen::Vector2d> shapely = spreadForShape(strokes, count);
  if (scaleFor(shapely) <= height_m) {
    return {shapely, height_m};
  }
  std::vector<Eigen::Vector2d> spaced = spreadForSpacing(strokes, shapely);
  const double scale_m = scaleFor(spaced);
  return {std::move(spaced), scale_m};
}

Eigen::Vector2d centreOf(const std::vector<Stroke>& strokes) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const Stroke& stroke : strokes) {
    for (const Eigen::Vector2d& point : stroke) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

const std::vector<Eigen::Vector3d>* ownGlyph(const config::Experiment& experiment, char character) {
  for (const config::NamedPoints& glyph : experiment.glyphs) {
    if (glyph.name == std::string(1, character) &&
        glyph.points_m.size() == experiment.vehicles.size()) {
      return &glyph.points_m;
    }
  }
  return nullptr;
}

PointsOrRefusal letterPoints(const config::Experiment& experiment, const StrokeFont& font,
                             char character) {
  const std::size_t count = experiment.vehicles.size();
  if (const auto* own = ownGlyph(experiment, character)) {
    if (auto refusal = refuseGoals(experiment, *own)) {
      return fmt::format("'{}': {}", character, *refusal);
    }
    return *own;
  }
  if (!font.has(character)) {
    return fmt::format("'{}' (code {}) has no strokes: printable ASCII has", character,
                       static_cast<int>(static_cast<unsigned char>(character)));
  }
  const std::vector<Stroke>& strokes = font.strokes(character);
  const Layout layout =
      layOut(strokes, count, experiment.fleet.letter_height_m, config::goalSpacingM(experiment));
  const Eigen::Vector2d centre = centreOf(strokes);
  std::vector<Eigen::Vector3d> points_m;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d placed =
        experiment.fleet.letter_centre_m + layout.scale_m * (layout.points[i] - centre);
    points_m.emplace_back(placed.x(), placed.y(), experiment.vehicles[i].height_m);
  }
  if (auto refusal = refuseGoals(experiment, points_m)) {
    return fmt::format("'{}' for {} vehicles is {:.1f} m high: {}", character, count,
                       layout.scale_m, *refusal);
  }
  return points_m;
}

}  // namespace roundabout::fleet
