#include "logs/metrics/formations.h"

#include <algorithm>
#include <limits>

#include "logs/metrics/motion.h"

namespace roundabout::logs {

namespace {

// Goals carry the time of the first status of their phase; that one may be lost.
constexpr double kGoalBeforeStatusS = 0.5;

bool isFormation(const PhaseMetrics& phase) {
  return !phase.formation.empty() &&
         (phase.phase == FleetPhase::kGo || phase.phase == FleetPhase::kHold);
}

/// The last place that a vehicle was sent to in a span of data time; nullptr if there is none.
const core::Goal* goalBetween(const Flight& flight, const FlightVehicle& vehicle, double begin_s,
                              double end_s) {
  const core::Goal* found = nullptr;
  for (const Logged<core::Goal>& goal : vehicle.goals) {
    const double at_s = flight.secondsAt(goal.value.utime);
    if (goal.value.phase == core::GoalPhase::kGo && at_s > begin_s - kGoalBeforeStatusS &&
        at_s < end_s) {
      found = &goal.value;
    }
  }
  return found;
}

LegMetrics legOf(const Flight& flight, const FlightVehicle& vehicle, const core::Goal& goal,
                 std::size_t end_frame) {
  LegMetrics leg;
  leg.vehicle = vehicle.name;
  leg.goal_world_m = goal.position_world_m;
  leg.goal_at_s = flight.secondsAt(goal.utime);
  const auto distance = [&](std::size_t frame) {
    return (vehicle.samples[frame].position_world_m - goal.position_world_m).head<2>().norm();
  };
  std::size_t frame = flight.frameAt(goal.utime);
  while (frame < end_frame && !vehicle.samples[frame].tracked) {
    ++frame;
  }
  const std::size_t begin_frame = frame;
  if (begin_frame >= end_frame) {
    return leg;
  }
  leg.straight_line_m = distance(begin_frame);
  for (; frame < end_frame && !leg.reached; ++frame) {
    leg.reached = vehicle.samples[frame].tracked && distance(frame) <= kGoalDistanceM;
    if (leg.reached) {
      leg.time_to_goal_s = flight.secondsAt(flight.frames[frame].utime) - leg.goal_at_s;
      leg.extra_time_s = leg.time_to_goal_s - std::max(leg.straight_line_m - kGoalDistanceM, 0.0) /
                                                  vehicle.preferred_speed_mps;
    }
  }
  leg.path_length_m = pathLength(vehicle, begin_frame, frame);
  return leg;
}

int countBegun(const std::vector<Encounter>& encounters, double begin_s, double end_s) {
  return static_cast<int>(
      std::count_if(encounters.begin(), encounters.end(), [&](const Encounter& encounter) {
        return encounter.begin_at_s >= begin_s && encounter.begin_at_s < end_s;
      }));
}

/// True if a phase goes on with a formation: the hold after its go, or the same goals given again
/// by a fleet process that was restarted. The same letter twice in a word has goals of its own.
bool continues(const Flight& flight, const FormationMetrics& formation, const PhaseMetrics& phase) {
  if (formation.name != phase.formation || formation.step != phase.step) {
    return false;
  }
  if (phase.phase == FleetPhase::kHold) {
    return true;
  }
  return std::any_of(
      flight.vehicles.begin(), flight.vehicles.end(), [&](const FlightVehicle& vehicle) {
        const core::Goal* before =
            goalBetween(flight, vehicle, formation.begin_at_s, formation.end_at_s);
        const core::Goal* now = goalBetween(flight, vehicle, phase.begin_at_s, phase.end_at_s);
        return before != nullptr && now != nullptr && before->goal_id == now->goal_id;
      });
}

void measure(const Flight& flight, const GapsOverTime& gaps, const SeparationMetrics& separation,
             FormationMetrics& formation) {
  const std::size_t begin = flight.frameAt(flight.utimeAt(formation.begin_at_s));
  const std::size_t end = flight.frameAt(flight.utimeAt(formation.end_at_s));
  for (const FlightVehicle& vehicle : flight.vehicles) {
    if (const core::Goal* goal =
            goalBetween(flight, vehicle, formation.begin_at_s, formation.end_at_s)) {
      formation.legs.push_back(legOf(flight, vehicle, *goal, end));
    }
  }
  // The fleet holds a formation without the vehicles that it has given up on.
  if (!std::all_of(formation.legs.begin(), formation.legs.end(),
                   [](const LegMetrics& leg) { return leg.reached; })) {
    formation.formed = false;
    formation.time_to_form_s = std::numeric_limits<double>::quiet_NaN();
  }
  formation.body_gap = closestIn(flight, gaps, begin, end);
  formation.touches = countBegun(separation.touches, formation.begin_at_s, formation.end_at_s);
  formation.approaches =
      countBegun(separation.approaches, formation.begin_at_s, formation.end_at_s);
}

}  // namespace

std::vector<PhaseMetrics> phasesOf(const Flight& flight) {
  std::vector<PhaseMetrics> phases;
  if (flight.frames.empty()) {
    return phases;
  }
  core::Utime latest = 0;
  for (const Logged<FleetStatus>& entry : flight.fleet) {
    const FleetStatus& status = entry.value;
    if (status.utime <= latest) {
      continue;
    }
    latest = status.utime;
    const double at_s = flight.secondsAt(status.utime);
    if (!phases.empty()) {
      phases.back().end_at_s = at_s;
    }
    if (phases.empty() || phases.back().phase != status.phase ||
        phases.back().formation != status.formation || phases.back().step != status.step) {
      phases.push_back({status.phase, status.formation, status.step, at_s, at_s});
    }
  }
  if (!phases.empty()) {
    const double end_s = flight.secondsAt(flight.frames.back().utime);
    phases.back().end_at_s = std::max(phases.back().end_at_s, end_s);
  }
  return phases;
}

std::vector<FormationMetrics> formationsOf(const Flight& flight,
                                           const std::vector<PhaseMetrics>& phases,
                                           const GapsOverTime& gaps,
                                           const SeparationMetrics& separation) {
  std::vector<FormationMetrics> formations;
  for (const PhaseMetrics& phase : phases) {
    if (!isFormation(phase)) {
      continue;
    }
    if (formations.empty() || !continues(flight, formations.back(), phase)) {
      FormationMetrics formation;
      formation.name = phase.formation;
      formation.step = phase.step;
      formation.begin_at_s = phase.begin_at_s;
      formations.push_back(formation);
    }
    FormationMetrics& formation = formations.back();
    formation.end_at_s = phase.end_at_s;
    if (phase.phase == FleetPhase::kHold && !formation.formed) {
      formation.formed = true;
      // A log that begins during the hold does not tell.
      if (phase.begin_at_s > formation.begin_at_s) {
        formation.time_to_form_s = phase.begin_at_s - formation.begin_at_s;
      }
    }
  }
  for (FormationMetrics& formation : formations) {
    measure(flight, gaps, separation, formation);
  }
  return formations;
}

}  // namespace roundabout::logs
