#include "planner/planner_core.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/error.h"

namespace roundabout::planner {

namespace {

std::size_t indexOf(const config::Experiment& experiment, const std::string& vehicle) {
  std::string known;
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    if (experiment.vehicles[i].name == vehicle) {
      return i;
    }
    known += (i == 0 ? "" : ", ") + experiment.vehicles[i].name;
  }
  throw core::StartupError(experiment.file, "--vehicle", "one of " + known, "\"" + vehicle + "\"");
}

bool finite(const core::Command& command) {
  return command.velocity_world_mps.allFinite() && command.position_world_m.allFinite() &&
         std::isfinite(command.heading_world_rad) && std::isfinite(command.heading_rate_radps);
}

}  // namespace

PlannerCore::PlannerCore(const config::Experiment& experiment, const std::string& vehicle,
                         std::unique_ptr<Policy> policy)
    : experiment_(experiment),
      own_index_(indexOf(experiment, vehicle)),
      tracks_(experiment),
      seen_(experiment, own_index_),
      timer_(experiment.planner.rate_hz),
      room_(experiment.room, experiment.vehicles[own_index_], experiment.safety.room_land_margin_m),
      pilot_(experiment, own_index_, std::move(policy)),
      shield_(experiment, own_index_) {}

std::optional<PlannerCore::Tick> PlannerCore::onFrame(const core::StatesFrame& frame) {
  const core::Utime before = gate_.last();
  switch (gate_.judge(frame.utime)) {
    case core::FrameVerdict::kRefused:
      onRejected();
      return std::nullopt;
    case core::FrameVerdict::kNewEpoch:
      beginAnew();
      break;
    case core::FrameVerdict::kAccepted:
      break;
  }
  if (first_frame_ == 0) {
    first_frame_ = frame.utime;
  } else {
    noteGap(before, frame.utime);
  }
  rejected_messages_ += tracks_.update(frame);
  if (!timer_.due(frame.utime)) {
    return std::nullopt;
  }
  return tick(frame.utime);
}

void PlannerCore::noteGap(core::Utime before, core::Utime now) {
  const double gap_s = core::toSeconds(now - before);
  modes_.noteGap(gap_s, experiment_.safety);
  if (gap_s >= experiment_.safety.states_hold_s) {
    shield_.noteSilence(before + core::toUtime(experiment_.safety.states_hold_s), situation());
  }
}

/// The states' time went back: nothing from before can be compared with what comes.
void PlannerCore::beginAnew() {
  tracks_ = TrackTable(experiment_);
  timer_ = core::TickTimer(experiment_.planner.rate_hz);
  first_frame_ = 0;
  orders_.beginAnew();
  goals_.clear();
  seen_.clear();
  modes_.beginAnew();
  pilot_.beginAnew();
  shield_.beginAnew();
}

const char* PlannerCore::onGoal(const core::Goal& goal) {
  const char* const refusal = goals_.offer(goal, gate_.last(), room_, situation());
  rejected_messages_ += refusal == nullptr ? 0 : 1;
  return refusal;
}

const char* PlannerCore::onOrder(const core::SafetyOrder& order) {
  if (!order.vehicle.empty() && order.vehicle != vehicle().name) {
    const bool known = std::any_of(
        experiment_.vehicles.begin(), experiment_.vehicles.end(),
        [&](const config::Vehicle& candidate) { return candidate.name == order.vehicle; });
    rejected_messages_ += known ? 0 : 1;
    return known ? nullptr : "for a vehicle that the experiment does not have";
  }
  const char* const refusal = orders_.take(order, started(), modes_.latch());
  rejected_messages_ += refusal == nullptr ? 0 : 1;
  return refusal;
}

const char* PlannerCore::onScan(const core::LaserScan& scan) {
  if (scan.utime < 0 || (started() && scan.utime > gate_.last() + core::kFarAhead)) {
    onRejected();
    return "its time stamp is corrupt";
  }
  pilot_.onScan(scan);
  return nullptr;
}

const char* PlannerCore::onTracks(const core::AgentTracks& tracks) {
  const char* const refusal = seen_.offer(tracks, gate_.last());
  rejected_messages_ += refusal == nullptr ? 0 : 1;
  return refusal;
}

const char* PlannerCore::onOthersCommand(const core::Command& command) {
  const char* const refusal = shield_.onCommand(command, gate_.last());
  rejected_messages_ += refusal == nullptr ? 0 : 1;
  return refusal;
}

const char* PlannerCore::onMap(const core::OccupancyMap& map) {
  if (map.utime < 0 || (started() && map.utime > gate_.last() + core::kFarAhead)) {
    onRejected();
    return "its time stamp is corrupt";
  }
  const config::Room& room = experiment_.room;
  const char* refusal = "its resolution is not that of its tree";
  auto grid = OccupancyGrid::fromTree(
      map.tree, Eigen::AlignedBox2d(room.min_m.head<2>(), room.max_m.head<2>()), &refusal);
  if (!grid || !(std::abs(grid->resolution() - map.resolution_m) < 1e-6)) {
    onRejected();
    return refusal;
  }
  pilot_.onMap(map.utime, std::move(*grid));
  return nullptr;
}

void PlannerCore::applyGoals(core::Utime now) {
  const GoalQueue::Change change = goals_.apply(now, first_frame_, situation());
  rejected_messages_ += change.refused;
  if (change.from_past && !orders_.resumed()) {
    modes_.noteGoalFromThePast();
  }
  if (change.is_new) {
    modes_.noteNewGoal();
    pilot_.noteNewGoal();
    shield_.noteNewGoal();
  }
}

PlannerCore::Tick PlannerCore::tick(core::Utime now) {
  applyGoals(now);
  seen_.apply(now);
  pilot_.applyMaps(now);
  shield_.observe(now, situation());
  const Sight seen = sight(now);
  const Verdict verdict =
      modes_.decide(now, core::toSeconds(timer_.periodUs()), situation(), goals_, room_, seen);
  const bool stopped = verdict.mode == Mode::kHolding && verdict.reason == seen.missing;
  ticks_without_tracks_ += stopped && seen_.used() && !seen_.fresh() ? 1 : 0;
  const Tick result = report(now, now, verdict);
  shield_.onSent(result.command, situation());
  return result;
}

/// Whether the vehicle sees what it drives by.
Sight PlannerCore::sight(core::Utime now) {
  if (!pilot_.seesEnough(now)) {
    return {"no laser scan"};
  }
  if (!seen_.used() || seen_.fresh()) {
    return {};
  }
  return {seen_.blindReason().empty() ? "no tracks from perception"
                                      : "perception is blind: " + seen_.blindReason()};
}

PlannerCore::Tick PlannerCore::onSilence(double silence_s) {
  return report(gate_.last() + core::toUtime(silence_s), gate_.last(),
                modes_.decideOnSilence(silence_s, experiment_.safety, goals_));
}

PlannerCore::Tick PlannerCore::report(core::Utime now, core::Utime state_utime,
                                      const Verdict& verdict) {
  const Track& own = tracks_.at(own_index_);
  Tick result;
  Status& status = result.status;
  status.utime = now;
  status.mode = verdict.mode;
  status.reason = verdict.reason;
  status.goal = goals_.current();
  status.closest_separation_m = situation().closestSeparation(now);
  status.rejected_measurements = tracks_.rejectedMeasurements();
  status.missed_ticks = timer_.missed();
  if (seen_.used()) {
    status.tracks_used = static_cast<int>(seen_.agents().size());
    status.tracks_age_s = seen_.ageS();
    status.ticks_without_tracks = ticks_without_tracks_;
  }
  status.state_age_s =
      own.seen() ? own.sinceAcceptedS(now) : std::numeric_limits<double>::infinity();
  if (status.goal && own.seen()) {
    status.distance_to_goal_m =
        (status.goal->position_world_m.head<2>() - own.positionAt(now)).norm();
  }

  core::Command& command = result.command;
  command.utime = now;
  command.state_utime = state_utime;
  command.vehicle = vehicle().name;
  command.valid_for_s = experiment_.planner.command_valid_s;
  command.position_world_m = own.state().position_world_m;
  command.heading_world_rad = core::headingOf(own.state().orientation);
  fill(now, command, status);
  stopUnlessFinite(command, status);
  FlightShield::Mapped mapped{pilot_.mappedNear(own.positionAt(now)), std::nullopt};
  if (status.mode == Mode::kFlying) {
    mapped.next_place_m = pilot_.nextPlace();
  }
  shield_.guard(now, situation(), mapped, command, status);
  stopUnlessFinite(command, status);
  limitValidity(now, command);
  status.rejected_messages = rejected_messages_;
  return result;
}

/// What the mode asks for.
void PlannerCore::fill(core::Utime now, core::Command& command, Status& status) {
  switch (status.mode) {
    case Mode::kFlying:
      pilot_.fly(now, situation(), *goals_.current(), room_, command, status);
      break;
    case Mode::kTakingOff:
    case Mode::kAtGoal:
      Pilot::holdGoal(situation(), *goals_.current(), room_, command);
      break;
    case Mode::kLanding:
    case Mode::kLanded:
      command.mode = core::CommandMode::kLand;
      break;
    case Mode::kKilled:
      command.mode = core::CommandMode::kKill;
      break;
    case Mode::kNeverHeard:
    case Mode::kWaiting:
    case Mode::kOnFloor:
    case Mode::kHolding:
      command.mode = core::CommandMode::kHold;
      break;
  }
}

/// A command decided on a state that is already old expires so that the vehicle holds when the
/// state is too old.
void PlannerCore::limitValidity(core::Utime now, core::Command& command) const {
  const bool moves =
      command.mode == core::CommandMode::kVelocity || command.mode == core::CommandMode::kPosition;
  const double age_s = tracks_.at(own_index_).ageS(now);
  if (moves && age_s > 0.0) {
    command.valid_for_s =
        std::min(command.valid_for_s, experiment_.safety.own_track_hold_s - age_s);
  }
}

void PlannerCore::stopUnlessFinite(core::Command& command, Status& status) {
  if (finite(command)) {
    return;
  }
  const core::VehicleState& own = tracks_.at(own_index_).state();
  onRejected();
  status.mode = Mode::kHolding;
  status.reason = "the policy returned something that is not a number";
  command.mode = core::CommandMode::kHold;
  command.velocity_world_mps.setZero();
  command.position_world_m = own.position_world_m;
  command.heading_world_rad = core::headingOf(own.orientation);
  command.heading_rate_radps = 0.0;
}

Status PlannerCore::waitingStatus() const {
  Status status;
  status.reason = "no vehicle states yet";
  status.rejected_messages = rejected_messages_;
  return status;
}

}  // namespace roundabout::planner
