#include "tests/logs/synthetic_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <spdlog/fmt/fmt.h>

#include "common/bus/messages.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"
#include "tests/logs/log_writer.h"

namespace roundabout::logs {

namespace {

constexpr core::Utime kFirstUtime = 1'000'000;
constexpr core::Utime kFrameUs = 5000;
constexpr core::Utime kLogEpoch = 1'700'000'000'000'000;
constexpr int kFramesPerPlannerTick = 20;
constexpr int kFramesPerFleetTick = 40;

/// What the fleet is flying and which goals that has.
struct Current {
  const SyntheticFormation* formation = nullptr;
  int number = -1;  // of goals; a restarted fleet gives the same goals again
};

Current currentAt(const SyntheticFlight& flight, double at_s) {
  Current current;
  for (const SyntheticFormation& formation : flight.formations) {
    current.number += formation.restarted ? 0 : 1;
    if (at_s >= formation.begin_at_s && at_s < formation.end_at_s) {
      current.formation = &formation;
      return current;
    }
  }
  return {};
}

core::StatesFrame frameAt(const SyntheticFlight& flight, int number) {
  core::StatesFrame frame;
  frame.utime = kFirstUtime + number * kFrameUs;
  frame.frame_number = number;
  const double at_s = core::toSeconds(number * kFrameUs);
  constexpr double kStep = 1e-3;
  for (const SyntheticVehicle& vehicle : flight.vehicles) {
    core::VehicleState state;
    state.name = vehicle.name;
    state.position_world_m = vehicle.position_world_m(at_s);
    state.velocity_world_mps =
        (vehicle.position_world_m(at_s + kStep) - vehicle.position_world_m(at_s - kStep)) /
        (2.0 * kStep);
    state.tracked = at_s < vehicle.untracked_from_s || at_s >= vehicle.untracked_to_s;
    state.last_seen = frame.utime;
    frame.vehicles.push_back(state);
  }
  return frame;
}

void writePlanners(const SyntheticFlight& flight, LogWriter& log, core::Utime utime,
                   core::Utime log_utime) {
  const double at_s = core::toSeconds(utime - kFirstUtime);
  for (const SyntheticVehicle& vehicle : flight.vehicles) {
    if (at_s >= vehicle.planner_dies_at_s) {
      continue;
    }
    core::Command command;
    command.utime = utime;
    command.state_utime = utime;
    command.vehicle = vehicle.name;
    command.mode = core::CommandMode::kVelocity;
    command.valid_for_s = 0.3;
    log.write(log_utime + flight.command_delay_us, bus::commandChannel(vehicle.name),
              bus::toMessage(command));
    roundabout_msgs::planner_status_t status{};
    status.utime = utime;
    status.vehicle = vehicle.name;
    status.policy = "orca";
    status.mode = roundabout_msgs::planner_status_t::FLYING;
    status.compute_time = 5e-6;
    log.write(log_utime + flight.command_delay_us, bus::plannerStatusChannel(vehicle.name), status);
  }
}

void writeGoals(const SyntheticFlight& flight, const Current& current, LogWriter& log,
                core::Utime utime, core::Utime log_utime) {
  for (std::size_t i = 0; i < current.formation->goals_world_m.size(); ++i) {
    core::Goal goal;
    goal.utime = utime;
    goal.vehicle = flight.vehicles[i].name;
    goal.goal_id = (current.number + 1) * 1000 + static_cast<int>(i);
    goal.position_world_m = current.formation->goals_world_m[i];
    goal.phase = core::GoalPhase::kGo;
    log.write(log_utime, bus::goalChannel(goal.vehicle), bus::toMessage(goal));
    log.write(log_utime + 1, bus::goalChannel(goal.vehicle), bus::toMessage(goal));
  }
}

void writeFleet(const SyntheticFlight& flight, LogWriter& log, core::Utime utime,
                core::Utime log_utime) {
  const double at_s = core::toSeconds(utime - kFirstUtime);
  const Current current = currentAt(flight, at_s);
  const int formations = static_cast<int>(flight.formations.size());
  const bool after = formations > 0 && at_s >= flight.formations.back().end_at_s;
  roundabout_msgs::fleet_status_t status{};
  status.utime = utime;
  status.num_steps = flight.by_messages ? 0 : formations + flight.steps_left_out;
  status.step = flight.by_messages ? 0 : after ? formations - 1 : current.number;
  status.phase = after ? static_cast<std::int8_t>(flight.last_phase)
                       : roundabout_msgs::fleet_status_t::TAKE_OFF;
  if (const SyntheticFormation* formation = current.formation) {
    if (utime - kFirstUtime - core::toUtime(formation->begin_at_s) <
        kFrameUs * kFramesPerFleetTick) {
      writeGoals(flight, current, log, utime, log_utime);
    }
    status.formation = formation->name;
    status.phase = at_s < formation->formed_at_s ? roundabout_msgs::fleet_status_t::GO
                                                 : roundabout_msgs::fleet_status_t::HOLD;
  }
  log.write(log_utime, bus::kFleetStatusChannel, status);
}

}  // namespace

void SyntheticFlight::write(const std::string& log_file) const {
  LogWriter log(log_file);
  const int frames = static_cast<int>(std::lround(duration_s * 200.0)) + 1;
  for (int number = 0; number < frames; ++number) {
    if (lost_frames.contains(number)) {
      continue;
    }
    const core::StatesFrame frame = frameAt(*this, number);
    const core::Utime log_utime =
        kLogEpoch + std::llround(static_cast<double>(number * kFrameUs) * wall_clock_per_data) +
        (frame_jitter_us ? frame_jitter_us(number) : 0);
    log.write(log_utime, bus::kStatesChannel, bus::toMessage(frame));
    if (number % kFramesPerPlannerTick == 0) {
      writePlanners(*this, log, frame.utime, log_utime);
    }
    if (number % kFramesPerFleetTick == 0) {
      writeFleet(*this, log, frame.utime, log_utime);
    }
  }
}

config::Experiment SyntheticFlight::experiment(double preferred_speed_mps) const {
  config::Experiment experiment;
  experiment.name = "synthetic";
  experiment.sim.pacing = wall_clock_per_data == 1.0 ? "real_time" : "lockstep";
  for (const SyntheticVehicle& vehicle : vehicles) {
    config::Vehicle& added = experiment.vehicles.emplace_back();
    added.name = vehicle.name;
    added.preferred_speed_mps = preferred_speed_mps;
  }
  return experiment;
}

std::function<Eigen::Vector3d(double)> straight(const Eigen::Vector3d& from,
                                                const Eigen::Vector3d& to, double speed_mps,
                                                double begin_at_s) {
  const double duration_s = (to - from).norm() / speed_mps;
  return [=](double at_s) -> Eigen::Vector3d {
    return from + (to - from) * std::clamp((at_s - begin_at_s) / duration_s, 0.0, 1.0);
  };
}

std::function<Eigen::Vector3d(double)> standing(const Eigen::Vector3d& at) {
  return [at](double) { return at; };
}

SyntheticFlight showcase() {
  const std::vector<Eigen::Vector3d> start{{-4, 0, 1}, {4, 6, 1},  {-4, 5, 1},
                                           {4, 1, 1},  {0, -1, 1}, {-1, 7, 1}};
  const std::vector<Eigen::Vector3d> letter_c{{3, 6, 1}, {-1, 2, 1}, {3, 0, 1},
                                              {0, 0, 1}, {0, 6, 1},  {-1, 4, 1}};
  const std::vector<Eigen::Vector3d> letter_l{{0, 0, 1}, {0, 6, 1},   {0, 2, 1},
                                              {0, 4, 1}, {1.5, 0, 1}, {3, 0, 1}};
  SyntheticFlight flight;
  flight.duration_s = 32.0;
  flight.formations = {{"C", 3.0, 13.0, 16.0, letter_c}, {"L", 16.0, 26.0, 29.0, letter_l}};
  for (std::size_t i = 0; i < start.size(); ++i) {
    const auto position = [=](double at_s) -> Eigen::Vector3d {
      // A smooth step from place to place, bent to one side, after the climb and before landing.
      const auto leg = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                           double begin_at_s) -> Eigen::Vector3d {
        const double s =
            std::clamp((at_s - begin_at_s) / (8.0 + static_cast<double>(i) / 4), 0.0, 1.0);
        const double along = s * s * (3.0 - 2.0 * s);
        const Eigen::Vector3d way = to - from;
        const Eigen::Vector3d side(-way.y(), way.x(), 0.0);
        return from + way * along + 0.18 * std::sin(std::numbers::pi * along) * side;
      };
      Eigen::Vector3d place =
          at_s < 16.0 ? leg(start[i], letter_c[i], 3.0) : leg(letter_c[i], letter_l[i], 16.0);
      place.z() = std::clamp(std::min(at_s / 2.0, (31.5 - at_s) / 2.0), 0.0, 1.0);
      return place;
    };
    flight.vehicles.push_back({fmt::format("hex{}", i + 1), position});
  }
  return flight;
}

}  // namespace roundabout::logs
