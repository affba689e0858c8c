#include "logs/figures/what_if_figure.h"

#include <algorithm>

#include "common/plot/palette.h"
#include "common/plot/plan_view.h"

namespace roundabout::logs {

namespace {

using namespace plot;  // NOLINT(google-build-using-namespace): the drawing of this file

constexpr core::Utime kArrowEvery = core::kMicrosPerSecond / 2;
constexpr double kPathStepM = 0.03;
constexpr double kArrowS = 0.8;  // length of an arrow: what the velocity covers in this time

std::vector<std::string> pathRows(const FlightVehicle& vehicle, PlanView& view) {
  std::vector<std::string> rows;
  const Sample* last = nullptr;
  for (const Sample& sample : vehicle.samples) {
    if (!sample.tracked) {
      continue;
    }
    const Eigen::Vector3d& at = sample.position_world_m;
    if (last == nullptr || (at - last->position_world_m).norm() >= kPathStepM) {
      rows.push_back(fmt::format("{:.3f} {:.3f}", at.x(), at.y()));
      view.include(at.head<2>(), vehicle.body_radius_m);
      last = &sample;
    }
  }
  return rows;
}

std::string arrowRow(const Sample& sample, const core::Command& command) {
  const Eigen::Vector3d& at = sample.position_world_m;
  const Eigen::Vector3d way = kArrowS * command.velocity_world_mps;
  return fmt::format("{:.3f} {:.3f} {:.3f} {:.3f}", at.x(), at.y(), way.x(), way.y());
}

bool steers(const core::Command& command) { return command.mode == core::CommandMode::kVelocity; }

}  // namespace

void drawWhatIf(GnuplotScript& script, const Flight& flight, const FlightVehicle& vehicle,
                const CommandCheck& check, const std::string& policy, Figure& figure) {
  figure.title =
      fmt::format("{}: what {} would have done", vehicle.name, policy.substr(0, policy.find(':')));
  figure.caption =
      fmt::format("arrows every 0.5 s: what the commanded velocity covers in {} s", kArrowS);
  PlanView view;
  const std::vector<std::string> path = pathRows(vehicle, view);
  std::vector<std::string> flown;
  std::vector<std::string> other;
  core::Utime next = 0;
  for (const CommandPair& pair : check.pairs) {
    const std::size_t frame = flight.frameAt(pair.recorded.state_utime);
    const Sample& sample = vehicle.samples[frame];
    if (pair.recorded.state_utime < next || !sample.tracked || !pair.again ||
        (!steers(pair.recorded) && !steers(*pair.again))) {
      continue;
    }
    next = pair.recorded.state_utime + kArrowEvery;
    if (steers(pair.recorded)) {
      flown.push_back(arrowRow(sample, pair.recorded));
    }
    if (steers(*pair.again)) {
      other.push_back(arrowRow(sample, *pair.again));
    }
  }
  beginFigure(script, view.size(), figure.title);
  view.set(script, figure.caption);
  const std::string name = fmt::format("w{}", &vehicle - flight.vehicles.data());
  script.data(name + "path", path);
  script.data(name + "flown", flown);
  script.data(name + "other", other);
  const std::string color = hex(vehicleColor(
      static_cast<std::size_t>(&vehicle - flight.vehicles.data()), flight.vehicles.size()));
  std::vector<std::string> parts;
  parts.push_back(
      fmt::format("${}path with lines lw 1.2 lc rgb \"#9aa3af\" title \"flown\"", name));
  if (!flown.empty()) {
    parts.push_back(fmt::format(
        "${}flown with vectors filled head lw 4.5 lc rgb \"#c3cad4\" title \"was\"", name));
  }
  if (!other.empty()) {
    parts.push_back(fmt::format(
        "${}other with vectors filled head lw 1.8 lc rgb \"{}\" title \"would be\"", name, color));
  }
  endFigure(script, view.size(), figure.files(), fmt::format("plot {}", fmt::join(parts, ", ")));
}

}  // namespace roundabout::logs
