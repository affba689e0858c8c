#include "common/plot/plan_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace roundabout::plot {

namespace {

// Pixels.
constexpr double kPlot = 460.0;
constexpr int kMinWidth = 330;
constexpr int kLeft = 72;
constexpr int kRight = 110;
constexpr int kTop = 50;
constexpr int kBottom = 80;
constexpr double kMarginM = 0.3;

constexpr double kCaptionSize = 9.0;
// Wide is a letter of a caption of that size, on average.
constexpr double kLetter = 6.2;

}  // namespace

void PlanView::include(const Eigen::Vector2d& centre, double radius_m) {
  const Eigen::Vector2d low = centre.array() - radius_m;
  const Eigen::Vector2d high = centre.array() + radius_m;
  min_m_ = empty_ ? low : min_m_.cwiseMin(low).eval();
  max_m_ = empty_ ? high : max_m_.cwiseMax(high).eval();
  empty_ = false;
}

Eigen::Vector2d PlanView::extent() const {
  // At least as wide as the title.
  Eigen::Vector2d extent_m = (max_m_ - min_m_).array() + 2.0 * kMarginM;
  extent_m.x() = std::max(extent_m.x(), extent_m.y() * kMinWidth / kPlot);
  return extent_m;
}

double PlanView::pixelsPerMetre() const { return kPlot / extent().maxCoeff(); }

CanvasSize PlanView::size() const {
  const Eigen::Vector2d plot = extent() * pixelsPerMetre();
  return {static_cast<int>(std::lround(plot.x())) + kLeft + kRight,
          static_cast<int>(std::lround(plot.y())) + kTop + kBottom};
}

void PlanView::set(GnuplotScript& script, const std::string& caption) const {
  const CanvasSize canvas = size();
  const Eigen::Vector2d centre = (min_m_ + max_m_) / 2.0;
  const Eigen::Vector2d half = extent() / 2.0;
  script.line("set xrange [{:.3f}:{:.3f}]", centre.x() - half.x(), centre.x() + half.x());
  script.line("set yrange [{:.3f}:{:.3f}]", centre.y() - half.y(), centre.y() + half.y());
  script.line("set size ratio -1");
  script.line("set lmargin at screen {:.4f}", static_cast<double>(kLeft) / canvas.width);
  script.line("set rmargin at screen {:.4f}", 1.0 - static_cast<double>(kRight) / canvas.width);
  script.line("set bmargin at screen {:.4f}", static_cast<double>(kBottom) / canvas.height);
  script.line("set tmargin at screen {:.4f}", 1.0 - static_cast<double>(kTop) / canvas.height);
  script.line("set xlabel \"x (m)\"");
  // Smaller if that is what it takes to stay in the picture.
  const double fits = canvas.width / (kLetter * static_cast<double>(caption.size() + 1));
  script.line(
      "set label 1 {} at screen 0.5, screen 0.025 center tc rgb \"#667385\" font \",{:.1f}\"",
      gnuplotString(caption), kCaptionSize * std::min(1.0, fits));
  script.line("set ylabel \"y (m)\"");
  script.line("set key at graph 1.02, 1 left top Left reverse samplen 1 spacing 1.3");
}

std::vector<std::string> starRows(const Eigen::Vector2d& centre, double radius_m) {
  constexpr double kInnerRatio = 0.42;
  std::vector<std::string> rows;
  for (int corner = 0; corner <= 10; ++corner) {
    const double angle_rad = std::numbers::pi * (0.5 + corner / 5.0);
    const double reach_m = corner % 2 == 0 ? radius_m : kInnerRatio * radius_m;
    rows.push_back(fmt::format("{:.4f} {:.4f}", centre.x() + reach_m * std::cos(angle_rad),
                               centre.y() + reach_m * std::sin(angle_rad)));
  }
  return rows;
}

std::vector<std::string> outlineRows(const std::vector<Eigen::Vector2d>& corners_m) {
  std::vector<std::string> rows;
  for (const Eigen::Vector2d& corner : corners_m) {
    rows.push_back(fmt::format("{:.3f} {:.3f}", corner.x(), corner.y()));
  }
  rows.push_back(rows.front());
  return rows;
}

}  // namespace roundabout::plot
