#include "logs/figures/figures.h"

#include <cctype>
#include <filesystem>

#include "logs/figures/formation_figure.h"
#include "logs/figures/time_figures.h"
#include "logs/files.h"

namespace roundabout::logs {

namespace {

/// Formations may be named by any character; files shall not be.
std::string fileNameOf(const std::string& formation) {
  std::string name;
  for (const char character : formation) {
    const auto byte = static_cast<unsigned char>(character);
    name += std::isalnum(byte) != 0 ? std::string(1, character) : fmt::format("x{:02x}", byte);
  }
  return name;
}

Figure figureIn(const std::string& folder, const std::string& name) {
  const std::string stem = (std::filesystem::path(folder) / name).string();
  return {"", "", stem + ".png", stem + ".svg"};
}

}  // namespace

std::size_t Figures::count() const {
  return formations.size() + over_time.size() + (overview.png_file.empty() ? 0 : 1);
}

Figures drawFlight(const Flight& flight, const Metrics& metrics, const std::string& folder) {
  makeFolder(folder);
  Figures figures;
  if (flight.frames.empty()) {
    return figures;
  }
  GnuplotScript script;
  for (std::size_t i = 0; i < metrics.formations.size(); ++i) {
    const FormationMetrics& formation = metrics.formations[i];
    Figure figure =
        figureIn(folder, fmt::format("formation_{:02}_{}", i + 1, fileNameOf(formation.name)));
    drawFormation(script, flight, formation, figure);
    figures.formations.push_back(figure);
  }
  figures.overview = figureIn(folder, "overview");
  drawOverview(script, flight, metrics, figures.overview);
  figures.over_time.push_back(figureIn(folder, "separation"));
  drawSeparation(script, flight, metrics, figures.over_time.back());
  figures.over_time.push_back(figureIn(folder, "speed"));
  drawSpeed(script, flight, metrics, figures.over_time.back());
  figures.over_time.push_back(figureIn(folder, "modes"));
  drawModes(script, flight, metrics, figures.over_time.back());
  figures.over_time.push_back(figureIn(folder, "rates"));
  drawRates(script, flight, metrics, figures.over_time.back());
  figures.over_time.push_back(figureIn(folder, "latency"));
  drawLatency(script, flight, metrics, figures.over_time.back());
  if (metrics.timing.real_time) {
    figures.over_time.push_back(figureIn(folder, "frame_intervals"));
    drawFrameIntervals(script, flight, metrics, figures.over_time.back());
  }
  script.run();
  return figures;
}

}  // namespace roundabout::logs
