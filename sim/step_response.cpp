#include "sim/step_response.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/core/command.h"
#include "common/core/vehicle_state.h"
#include "sim/world.h"

namespace roundabout::sim {

namespace {

constexpr double kHoverSeconds = 8.0;
constexpr double kHeightM = 1.0;
constexpr core::Utime kCommandPeriodUs = 100'000;

config::Experiment oneMultirotor(const config::Sim& sim) {
  config::Experiment experiment;
  experiment.sim = sim;
  experiment.vehicles.resize(1);
  experiment.vehicles[0].name = "multirotor";
  experiment.vehicles[0].top_speed_mps = 100.0;
  experiment.vehicles[0].start = config::Start{};
  return experiment;
}

core::Command hover() {
  core::Command command;
  command.mode = core::CommandMode::kPosition;
  command.position_world_m.z() = kHeightM;
  command.valid_for_s = 0.3;
  return command;
}

core::Command stepCommand(StepKind kind, double size) {
  core::Command command = hover();
  if (kind == StepKind::kVelocity) {
    command.mode = core::CommandMode::kVelocity;
    command.velocity_world_mps.x() = size;
  } else if (kind == StepKind::kPosition) {
    command.position_world_m.x() = size;
  } else {
    command.heading_world_rad = size;
  }
  return command;
}

void fly(World& world, core::Command command, core::Utime until,
         const std::function<void()>& after_step) {
  for (core::Utime next_command = world.now(); world.now() < until;) {
    if (world.now() >= next_command) {
      command.utime = world.now();
      world.accept(0, command);
      next_command += kCommandPeriodUs;
    }
    world.step();
    after_step();
  }
}

double responseOf(const BodyState& body, StepKind kind) {
  switch (kind) {
    case StepKind::kVelocity:
      return body.velocity_world_mps.x();
    case StepKind::kPosition:
      return body.position_world_m.x();
    case StepKind::kHeading:
      break;
  }
  return core::headingOf(body.orientation);
}

// First time at which the response has reached that share of the step.
double timeOf(const std::vector<StepSample>& response, double level) {
  const auto reached =
      std::find_if(response.begin(), response.end(),
                   [level](const StepSample& sample) { return sample.response >= level; });
  return reached == response.end() ? std::nan("") : reached->time_s;
}

}  // namespace

std::vector<StepSample> stepResponse(const config::Sim& sim, StepKind kind, double size,
                                     double duration_s) {
  World world(oneMultirotor(sim), 0);
  const core::Utime begin = core::toUtime(kHoverSeconds);
  fly(world, hover(), begin, [] {});

  std::vector<StepSample> response;
  double last_speed_mps = world.bodies()[0].velocity_world_mps.x();
  fly(world, stepCommand(kind, size), begin + core::toUtime(duration_s), [&] {
    const BodyState& body = world.bodies()[0];
    const double speed_mps = body.velocity_world_mps.x();
    const double up = (body.orientation * Eigen::Vector3d::UnitZ()).z();
    response.push_back({core::toSeconds(world.now() - begin), responseOf(body, kind),
                        std::acos(std::clamp(up, -1.0, 1.0)),
                        (speed_mps - last_speed_mps) / core::toSeconds(world.stepUs())});
    last_speed_mps = speed_mps;
  });
  return response;
}

double stoppingDistanceM(const config::Sim& sim, double speed_mps) {
  World world(oneMultirotor(sim), 0);
  const core::Utime begin = core::toUtime(kHoverSeconds);
  const core::Utime brake = begin + core::toUtime(kHoverSeconds);
  fly(world, hover(), begin, [] {});
  fly(world, stepCommand(StepKind::kVelocity, speed_mps), brake, [] {});
  const double begin_m = world.bodies()[0].position_world_m.x();
  double farthest_m = begin_m;
  core::Command hold = hover();
  hold.mode = core::CommandMode::kHold;
  fly(world, hold, brake + core::toUtime(kHoverSeconds),
      [&] { farthest_m = std::max(farthest_m, world.bodies()[0].position_world_m.x()); });
  return farthest_m - begin_m;
}

StepFigures figuresOf(const std::vector<StepSample>& response, double size) {
  StepFigures figures{};
  figures.delay_s = timeOf(response, 0.05 * size);
  figures.lag_s = timeOf(response, (1.0 - std::exp(-1.0)) * size);
  figures.rise_s = timeOf(response, 0.9 * size) - timeOf(response, 0.1 * size);
  figures.steady = response.back().response / size;
  const double step_s = response[1].time_s - response[0].time_s;
  double last_acceleration = 0.0;
  for (const StepSample& sample : response) {
    figures.overshoot = std::max(figures.overshoot, sample.response / size - 1.0);
    figures.settled_s =
        std::abs(sample.response / size - 1.0) > 0.05 ? sample.time_s : figures.settled_s;
    figures.max_tilt_rad = std::max(figures.max_tilt_rad, sample.tilt_rad);
    figures.max_acceleration_mps2 =
        std::max(figures.max_acceleration_mps2, std::abs(sample.acceleration_mps2));
    figures.max_jerk_mps3 = std::max(
        figures.max_jerk_mps3, std::abs(sample.acceleration_mps2 - last_acceleration) / step_s);
    last_acceleration = sample.acceleration_mps2;
  }
  return figures;
}

}  // namespace roundabout::sim
