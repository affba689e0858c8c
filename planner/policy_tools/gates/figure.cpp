#include "planner/policy_tools/gates/figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/plot/canvas.h"
#include "common/plot/palette.h"
#include "common/plot/plan_view.h"

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;
using plot::Color;
using plot::GnuplotScript;

// Pixels.
constexpr int kRow = 310;
constexpr int kTop = 40;
constexpr int kBottom = 62;
constexpr int kPlot = kRow - kTop - kBottom;
constexpr int kLeft = 60;
constexpr int kMostSceneWidth = 700;
constexpr int kBetween = 95;
constexpr int kGateWidth = 330;
constexpr int kRight = 165;  // for the key

constexpr double kLabelGap_m = 0.3;

constexpr Color kEgo{214, 39, 40};
constexpr Color kOther{90, 104, 122};
constexpr Color kStatePart{31, 119, 180};
constexpr Color kHiddenPart{255, 153, 51};
constexpr Color kBiasPart{140, 190, 120};

struct Drawn {
  Vector2d position_m;
  Vector2d velocity_mps;
  double radius_m;
};

/// The others in the order in which they were read, back from the ego frame.
std::vector<Drawn> othersAsRead(const GateAnalysis& analysis) {
  const core::EgoAgent& ego = analysis.scene.ego;
  const Vector2d parallel = (ego.goal_world_m - ego.position_world_m).normalized();
  const Vector2d orthogonal(-parallel.y(), parallel.x());
  std::vector<Drawn> drawn;
  for (const OtherFeatures& other : analysis.observation.others) {
    drawn.push_back(
        {ego.position_world_m + double{other[0]} * parallel + double{other[1]} * orthogonal,
         double{other[2]} * parallel + double{other[3]} * orthogonal, double{other[4]}});
  }
  return drawn;
}

/// The rectangle that holds all scenes, so that they are drawn to one scale.
struct Frame {
  Vector2d min_m = Vector2d::Constant(1e9);
  Vector2d max_m = Vector2d::Constant(-1e9);

  void include(const Vector2d& place_m, double reach_m) {
    min_m = min_m.cwiseMin(Vector2d(place_m.array() - reach_m));
    max_m = max_m.cwiseMax(Vector2d(place_m.array() + reach_m));
  }

  /// Of a panel to its scale. Pixels.
  int width() const {
    const Vector2d extent = max_m - min_m;
    return std::min(kMostSceneWidth, static_cast<int>(kPlot * extent.x() / extent.y()));
  }
};

Frame frameOf(const std::vector<GateAnalysis>& analyses) {
  constexpr double kMargin_m = 0.4;
  Frame frame;
  for (const GateAnalysis& analysis : analyses) {
    const core::EgoAgent& ego = analysis.scene.ego;
    frame.include(ego.position_world_m, ego.radius_m + kMargin_m);
    frame.include(ego.goal_world_m, ego.radius_m + kMargin_m);
    for (const Drawn& other : othersAsRead(analysis)) {
      frame.include(other.position_m, other.radius_m + kMargin_m);
      frame.include(other.position_m + other.velocity_mps, kMargin_m);
    }
  }
  return frame;
}

std::string arrow(const Drawn& agent) {
  return fmt::format("{:.4f} {:.4f} {:.4f} {:.4f}", agent.position_m.x(), agent.position_m.y(),
                     agent.velocity_mps.x(), agent.velocity_mps.y());
}

std::string disc(const Drawn& agent) {
  return fmt::format("{:.4f} {:.4f} {:.4f}", agent.position_m.x(), agent.position_m.y(),
                     agent.radius_m);
}

/// A text on the left of a disc as it flies, out of the way of arrows.
std::string label(const Drawn& agent, const std::string& text) {
  const double speed_mps = agent.velocity_mps.norm();
  const Vector2d left = speed_mps > 0.0 ? Vector2d(-agent.velocity_mps.y() / speed_mps,
                                                   agent.velocity_mps.x() / speed_mps)
                                        : Vector2d(0.0, 1.0);
  const Vector2d place = agent.position_m + (agent.radius_m + kLabelGap_m) * left;
  return fmt::format("{:.4f} {:.4f} \"{}\"", place.x(), place.y(), text);
}

void setPanel(GnuplotScript& script, const plot::CanvasSize& page, std::size_t row, int left,
              int right) {
  const double top = static_cast<double>(static_cast<int>(row) * kRow + kTop) / page.height;
  const double bottom =
      static_cast<double>((static_cast<int>(row) + 1) * kRow - kBottom) / page.height;
  script.line("set tmargin at screen {:.4f}", 1.0 - top);
  script.line("set bmargin at screen {:.4f}", 1.0 - bottom);
  script.line("set lmargin at screen {:.4f}", static_cast<double>(left) / page.width);
  script.line("set rmargin at screen {:.4f}", static_cast<double>(right) / page.width);
}

void drawScene(GnuplotScript& script, const GateAnalysis& analysis, const Frame& frame,
               std::size_t row) {
  const core::EgoAgent& ego = analysis.scene.ego;
  const Drawn self{ego.position_world_m, ego.velocity_world_mps, ego.radius_m};
  const std::vector<Drawn> others = othersAsRead(analysis);
  std::vector<std::string> discs;
  std::vector<std::string> labels = {label(self, "ego")};
  std::vector<std::string> arrows;
  for (std::size_t i = 0; i < others.size(); ++i) {
    discs.push_back(disc(others[i]));
    labels.push_back(label(others[i], std::to_string(i + 1)));
    arrows.push_back(arrow(others[i]));
  }
  const std::string id = std::to_string(row);
  script.data("others" + id, discs);
  script.data("arrows" + id, arrows);
  script.data("labels" + id, labels);
  script.data("ego" + id, {disc(self)});
  script.data("ego_arrow" + id, {arrow(self)});
  script.data("goal" + id, plot::starRows(ego.goal_world_m, 0.45));

  script.line("set title {}", plot::gnuplotString(analysis.scene.name));
  script.line("set key off");
  script.line("set xlabel \"x (m)\"");
  script.line("set ylabel \"y (m)\" offset 1");
  script.line("set xtics 2");
  script.line("set ytics 2");
  script.line("set size ratio -1");
  script.line("set xrange [{:.3f}:{:.3f}]", frame.min_m.x(), frame.max_m.x());
  script.line("set yrange [{:.3f}:{:.3f}]", frame.min_m.y(), frame.max_m.y());
  const auto circles = [](const std::string& block, const Color& color) {
    return fmt::format(
        "${0} using 1:2:3 with circles fc rgb \"{1}\" fs transparent solid 0.25 noborder, "
        "${0} using 1:2:3 with circles lc rgb \"{1}\" fs empty",
        block, plot::hex(color));
  };
  const auto vectors = [](const std::string& block, const Color& color) {
    return fmt::format("${} using 1:2:3:4 with vectors head filled size 0.25,20 lw 2 lc rgb \"{}\"",
                       block, plot::hex(color));
  };
  script.line(
      "plot {}, {}, {}, {}, $goal{} with filledcurves closed fc rgb \"{}\", "
      "$labels{} with labels font \",10\"",
      circles("others" + id, kOther), circles("ego" + id, kEgo), vectors("arrows" + id, kOther),
      vectors("ego_arrow" + id, kEgo), id, plot::hex(kEgo), id);
  script.line("set size noratio");
}

/// One slice of the stack, from zero to the sum of the columns up to its own.
std::string slice(const std::string& block, const std::string& height, const Color& color,
                  const std::string& title) {
  return fmt::format(
      "${0} using 1:({1}) with filledcurves y1=0 fc rgb \"{2}\" fs solid 0.85 title \"{3}\", "
      "${0} using 1:({1}) with lines lw 1.5 lc rgb \"white\"",
      block, height, plot::hex(color), title);
}

void drawStack(GnuplotScript& script, const GateAnalysis& analysis, double highest,
               std::size_t row) {
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < analysis.steps.size(); ++i) {
    const GateStep& step = analysis.steps[i];
    rows.push_back(fmt::format("{} {:.6f} {:.6f} {:.6f}", i + 1, step.state_part, step.hidden_part,
                               step.bias_part));
  }
  if (rows.size() == 1) {
    rows.push_back("2" + rows.front().substr(1));  // one agent has no area: as wide as a second
  }
  const std::string block = "gate" + std::to_string(row);
  script.data(block, rows);
  script.line("set title \"input gate\"");
  script.line("set key at graph 1.05, 1 left top Left reverse samplen 2 spacing 1.4 font \",10\"");
  script.line("set xlabel \"agent, in the order of reading\"");
  script.line("set ylabel \"mean over the units, split\" offset 1");
  script.line("set xtics 1");
  script.line("set ytics autofreq");
  script.line("set xrange [1:{}]", std::max<std::size_t>(analysis.steps.size(), 2));
  script.line("set yrange [0:{:.3f}]", 1.15 * highest);
  script.line("plot {}, {}, {}", slice(block, "$2+$3+$4", kBiasPart, "bias"),
              slice(block, "$2+$3", kHiddenPart, "hidden state"),
              slice(block, "$2", kStatePart, "agent's state"));
}

}  // namespace

void drawGates(const std::vector<GateAnalysis>& analyses, const std::filesystem::path& file) {
  const Frame frame = frameOf(analyses);
  const int scene_right = kLeft + frame.width();
  const int gate_left = scene_right + kBetween;
  const int gate_right = gate_left + kGateWidth;
  const plot::CanvasSize page{gate_right + kRight, kRow * static_cast<int>(analyses.size())};
  double highest = 0.0;
  for (const GateAnalysis& analysis : analyses) {
    for (const GateStep& step : analysis.steps) {
      highest = std::max(highest, step.mean);
    }
  }
  GnuplotScript script;
  for (const bool bitmap : {true, false}) {
    plot::beginPage(script, page, bitmap, file);
    script.line("set multiplot");
    for (std::size_t row = 0; row < analyses.size(); ++row) {
      setPanel(script, page, row, kLeft, scene_right);
      drawScene(script, analyses[row], frame, row);
      setPanel(script, page, row, gate_left, gate_right);
      drawStack(script, analyses[row], highest, row);
    }
    script.line("unset multiplot");
    script.line("set output");
  }
  script.run();
}

}  // namespace roundabout::planner
