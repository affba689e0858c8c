#include "learning/training/training_figure.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "common/plot/canvas.h"
#include "common/plot/palette.h"

namespace roundabout::learning {

namespace {

using core::StartupError;

constexpr std::size_t kPoints = 300;

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char character : line) {
    if (character == ',') {
      cells.emplace_back();
    } else {
      cells.back() += character;
    }
  }
  return cells;
}

std::size_t columnOf(const std::vector<std::string>& names, const std::string& name,
                     const std::string& path) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw StartupError(path, "columns", fmt::format("one called {}", name), "none");
  }
  return static_cast<std::size_t>(found - names.begin());
}

double numberOf(const std::vector<std::string>& cells, std::size_t column,
                const std::string& path) {
  double number = 0.0;
  const std::string text = column < cells.size() ? cells[column] : "";
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw StartupError(path, "progress", "a number", fmt::format("\"{}\"", text));
  }
  return number;
}

/// Between the points of a curve; beyond them its ends.
double rewardAt(const LearningCurve& curve, double episodes) {
  const auto after = std::lower_bound(curve.episodes.begin(), curve.episodes.end(), episodes);
  const auto i = static_cast<std::size_t>(after - curve.episodes.begin());
  if (i == 0 || i == curve.episodes.size()) {
    return i == 0 ? curve.reward.front() : curve.reward.back();
  }
  const double share =
      (episodes - curve.episodes[i - 1]) / (curve.episodes[i] - curve.episodes[i - 1]);
  return curve.reward[i - 1] + share * (curve.reward[i] - curve.reward[i - 1]);
}

/// "out/lstm.1/" is "lstm.1".
std::string nameOf(const std::string& run) {
  const std::filesystem::path path = std::filesystem::path(run).lexically_normal();
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

/// Of a group's figure: episodes, and the mean reward less its deviation, itself, and more.
std::vector<std::string> rowsOf(const std::vector<std::string>& runs) {
  std::vector<LearningCurve> curves;
  for (const std::string& run : runs) {
    curves.push_back(readLearningCurve(run));
  }
  const LearningBand band = bandOf(curves);
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < band.episodes.size(); ++i) {
    rows.push_back(fmt::format("{:.0f} {:.5f} {:.5f} {:.5f}", band.episodes[i],
                               band.mean[i] - band.deviation[i], band.mean[i],
                               band.mean[i] + band.deviation[i]));
  }
  return rows;
}

}  // namespace

LearningCurve readLearningCurve(const std::string& run) {
  const std::string path = std::filesystem::path(run) / "progress.csv";
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) {
    throw StartupError(path, "progress", "a table that `roundabout train` wrote", "none");
  }
  const std::vector<std::string> names = cellsOf(line);
  const std::size_t episodes = columnOf(names, "episodes", path);
  const std::size_t reward = columnOf(names, "reward", path);
  LearningCurve curve;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    const double at = numberOf(cells, episodes, path);
    // A run that was resumed has reports twice: the later ones hold.
    while (!curve.episodes.empty() && curve.episodes.back() >= at) {
      curve.episodes.pop_back();
      curve.reward.pop_back();
    }
    curve.episodes.push_back(at);
    curve.reward.push_back(numberOf(cells, reward, path));
  }
  if (curve.episodes.empty() || curve.episodes.back() <= 0.0) {
    throw StartupError(path, "progress", "a report of at least one episode", "none");
  }
  return curve;
}

LearningBand bandOf(const std::vector<LearningCurve>& curves) {
  double end = std::numeric_limits<double>::infinity();
  for (const LearningCurve& curve : curves) {
    end = std::min(end, curve.episodes.back());
  }
  LearningBand band;
  const auto count = static_cast<double>(curves.size());
  for (std::size_t point = 1; point <= kPoints; ++point) {
    const double at = end * static_cast<double>(point) / static_cast<double>(kPoints);
    double mean = 0.0;
    for (const LearningCurve& curve : curves) {
      mean += rewardAt(curve, at) / count;
    }
    double variance = 0.0;
    for (const LearningCurve& curve : curves) {
      const double off = rewardAt(curve, at) - mean;
      variance += off * off / std::max(count - 1.0, 1.0);
    }
    band.episodes.push_back(at);
    band.mean.push_back(mean);
    band.deviation.push_back(std::sqrt(variance));
  }
  return band;
}

std::vector<RunGroup> groupsOf(const std::vector<std::string>& runs) {
  std::vector<RunGroup> groups;
  for (const std::string& run : runs) {
    const std::string folder = nameOf(run);
    const std::size_t dot = folder.rfind('.');
    const bool has_seed = dot != std::string::npos && dot + 1 < folder.size() &&
                          folder.find_first_not_of("0123456789", dot + 1) == std::string::npos;
    const std::string name = has_seed ? folder.substr(0, dot) : "";
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const RunGroup& each) { return each.name == name; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), {name, {}});
    }
    group->runs.push_back(run);
  }
  return groups;
}

std::string drawTraining(const std::vector<std::string>& runs, const std::string& folder) {
  const std::vector<RunGroup> groups = groupsOf(runs);
  plot::GnuplotScript script;
  constexpr plot::CanvasSize kSize{800, 450};
  std::filesystem::create_directories(folder);
  const std::filesystem::path path(folder);
  const plot::PictureFiles files{path / "training.png", path / "training.svg"};
  plot::beginFigure(script, kSize,
                    runs.size() == 1 ? "Training" : fmt::format("Training, {} runs", runs.size()));
  script.line("set xlabel 'episodes'");
  script.line("set ylabel 'rolling reward'");
  script.line("set grid");
  script.line("set rmargin 6");
  if (groups.size() > 1) {
    script.line("set key right bottom noenhanced");
  }
  std::string bands;
  std::string means;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    script.data(fmt::format("band{}", i), rowsOf(groups[i].runs));
    const std::string color = plot::hex(plot::vehicleColor(i, groups.size()));
    const std::string title =
        groups.size() > 1 ? "title " + plot::gnuplotString(groups[i].name) : "notitle";
    bands += fmt::format(
        "{}$band{} using 1:2:4 with filledcurves fc rgb \"{}\" fs transparent solid 0.2 noborder "
        "notitle",
        bands.empty() ? "plot " : ", ", i, color);
    means += fmt::format(", $band{} using 1:3 with lines lw 2 lc rgb \"{}\" {}", i, color, title);
  }
  plot::endFigure(script, kSize, files, bands + means);
  script.run();
  return files.png;
}

}  // namespace roundabout::learning
