#include "planner/planner_core.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "common/core/angles.h"
#include "common/core/error.h"
#include "planner/command_law.h"

namespace roundabout::planner {

namespace {

// Near enough to the height of flight to count as taken off.
constexpr double kHeightReached_m = 0.15;
// Slower than this, a vehicle on the floor has landed (and one that drives has stopped).
constexpr double kAtRest_mps = 0.1;

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

// From a state to the first deceleration: the command's way through radio and autopilot, and the
// tilt that must turn.
double reactionS(const config::Experiment& experiment) {
  const config::MultirotorModel& model = experiment.sim.multirotor;
  return 1.0 / experiment.planner.rate_hz + model.command_delay_s +
         2.0 * model.attitude_time_constant_s;
}

}  // namespace

PlannerCore::PlannerCore(const config::Experiment& experiment, const std::string& vehicle,
                         std::unique_ptr<Policy> policy)
    : experiment_(experiment),
      own_index_(indexOf(experiment, vehicle)),
      policy_(std::move(policy)),
      tracks_(experiment),
      timer_(experiment.planner.rate_hz),
      room_(experiment.room, experiment.vehicles[own_index_], experiment.safety.room_land_margin_m,
            reactionS(experiment)) {
  others_.reserve(experiment.vehicles.size());
}

std::optional<PlannerCore::Tick> PlannerCore::onFrame(const core::StatesFrame& frame) {
  if (!gate_.accept(frame.utime)) {
    onRejected();
    return std::nullopt;
  }
  if (first_frame_ == 0) {
    first_frame_ = frame.utime;
  }
  rejected_messages_ += tracks_.update(frame);
  if (!timer_.due(frame.utime)) {
    return std::nullopt;
  }
  return tick(frame.utime);
}

void PlannerCore::onGoal(const core::Goal& goal) {
  const bool stale = goal_ && goal.utime < goal_->utime;
  const bool corrupt = started() && goal.utime - gate_.last() > core::kFarAhead;
  const bool outside =
      goal.phase != core::GoalPhase::kLand && !room_.inside(goal.position_world_m.head<2>());
  if (goal.vehicle != vehicle().name || stale || corrupt || outside) {
    onRejected();
    return;
  }
  pending_goals_.push_back(goal);
}

void PlannerCore::onOrder(const core::SafetyOrder& order) {
  if (!order.vehicle.empty() && order.vehicle != vehicle().name) {
    const bool known = std::any_of(
        experiment_.vehicles.begin(), experiment_.vehicles.end(),
        [&](const config::Vehicle& candidate) { return candidate.name == order.vehicle; });
    rejected_messages_ += known ? 0 : 1;
    return;
  }
  // What makes the vehicle safer is obeyed whatever its stamp; only an old RESUME is refused, and a
  // repeated one lifts nothing that was latched since.
  if (order.order == core::SafetyOrderKind::kResume) {
    if (order.utime < last_order_) {
      onRejected();
      return;
    }
    if (order.utime == obeyed_order_ && order.utime > 0) {
      return;
    }
  }
  last_order_ = std::max(last_order_, order.utime);
  obeyed_order_ = order.utime;
  latch_.order(order.order);
}

void PlannerCore::applyGoals(core::Utime now) {
  const auto ready = [&](const core::Goal& goal) { return goal.utime < now; };
  for (const core::Goal& goal : pending_goals_) {
    if (!ready(goal) || (goal_ && goal.utime < goal_->utime)) {
      continue;
    }
    if (!goal_ && goal.utime < first_frame_) {
      latch_.fault(Latch::kHold, "restarted during a flight; needs a resume");
    }
    if (!goal_ || goal_->goal_id != goal.goal_id || goal_->phase != goal.phase) {
      landing_done_ = false;
      policy_->reset();
    }
    goal_ = goal;
  }
  std::erase_if(pending_goals_, ready);
}

bool PlannerCore::inTheAir() const {
  const Track& own = tracks_.at(own_index_);
  return own.seen() && config::flies(vehicle()) &&
         own.state().position_world_m.z() - experiment_.room.min_m.z() >
             experiment_.safety.airborne_height_m;
}

bool PlannerCore::landedNow() const {
  const Track& own = tracks_.at(own_index_);
  return own.seen() && !inTheAir() && own.state().velocity_world_mps.norm() < kAtRest_mps;
}

void PlannerCore::latchFaults(core::Utime now) {
  const config::Safety& safety = experiment_.safety;
  const Track& own = tracks_.at(own_index_);
  if (!own.seen()) {
    return;
  }
  if (now == first_frame_ && inTheAir()) {
    latch_.fault(Latch::kHold, "restarted in the air; needs a resume");
  }
  // The next tick is one period away: land now if the limit would pass before it.
  const double period_s = core::toSeconds(timer_.periodUs());
  if (inTheAir() && own.ageS(now) + period_s > safety.own_track_land_s) {
    latch_.fault(Latch::kLand,
                 fmt::format("not tracked for {:.0f} ms", 1e3 * own.sinceAcceptedS(now)));
  }
  if (inTheAir() && room_.mustLand(own.state().position_world_m)) {
    latch_.fault(Latch::kLand,
                 fmt::format("more than {:.1f} m outside the room", safety.room_land_margin_m));
  }
}

std::string PlannerCore::lostNeighbour(core::Utime now) const {
  const Eigen::Vector2d own = tracks_.at(own_index_).positionAt(now);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Track& other = tracks_.at(i);
    if (i == own_index_ || !other.seen() ||
        other.ageS(now) <= experiment_.safety.other_track_lost_s) {
      continue;
    }
    const double distance_m = (other.state().position_world_m.head<2>() - own).norm();
    if (distance_m <= experiment_.safety.other_track_hold_radius_m) {
      return experiment_.vehicles[i].name;
    }
  }
  return {};
}

PlannerCore::Verdict PlannerCore::decideMode(core::Utime now) {
  const Track& own = tracks_.at(own_index_);
  latchFaults(now);
  switch (latch_.state()) {
    case Latch::kKill:
      return {Mode::kKilled, latch_.reason()};
    case Latch::kLand:
      landing_done_ = landing_done_ || landedNow();
      return {landing_done_ ? Mode::kLanded : Mode::kLanding, latch_.reason()};
    case Latch::kHold:
      return {Mode::kHolding, latch_.reason()};
    case Latch::kNone:
      break;
  }
  if (!own.seen()) {
    return {Mode::kWaiting, "own vehicle was never tracked"};
  }
  if (own.ageS(now) >= experiment_.safety.own_track_hold_s) {
    return {Mode::kHolding, own.lost() ? "own track is lost" : "own vehicle is not tracked"};
  }
  if (const std::string lost = lostNeighbour(now); !lost.empty() && inTheAir()) {
    return {Mode::kHolding, lost + " is near and not tracked"};
  }
  return obeyGoal();
}

PlannerCore::Verdict PlannerCore::obeyGoal() {
  if (!goal_) {
    return inTheAir() ? Verdict{Mode::kHolding, "in the air without a goal"}
                      : Verdict{Mode::kOnFloor, "no goal yet"};
  }
  const double height_m = tracks_.at(own_index_).state().position_world_m.z();
  switch (goal_->phase) {
    case core::GoalPhase::kTakeOff: {
      const bool reached = !config::flies(vehicle()) ||
                           std::abs(height_m - goal_->position_world_m.z()) < kHeightReached_m;
      return {reached ? Mode::kAtGoal : Mode::kTakingOff, ""};
    }
    case core::GoalPhase::kGo:
      if (config::flies(vehicle()) && !inTheAir()) {
        return {Mode::kOnFloor, "on the floor: a take-off must come before go"};
      }
      return {Mode::kFlying, ""};
    case core::GoalPhase::kLand:
      break;
  }
  landing_done_ = landing_done_ || landedNow();
  return {landing_done_ ? Mode::kLanded : Mode::kLanding, ""};
}

core::EgoAgent PlannerCore::egoAgent(core::Utime now) const {
  const Track& own = tracks_.at(own_index_);
  core::EgoAgent ego;
  ego.position_world_m = own.positionAt(now);
  ego.velocity_world_mps = own.state().velocity_world_mps.head<2>();
  ego.heading_world_rad = core::headingOf(own.state().orientation);
  ego.goal_world_m = goal_->position_world_m.head<2>();
  ego.preferred_speed_mps = vehicle().preferred_speed_mps;
  ego.radius_m = vehicle().assumed_radius_m;
  return ego;
}

void PlannerCore::collectOthers(core::Utime now) {
  others_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Track& track = tracks_.at(i);
    if (i == own_index_ || !track.seen()) {
      continue;
    }
    const config::Vehicle& other = experiment_.vehicles[i];
    others_.push_back({track.positionAt(now), track.state().velocity_world_mps.head<2>(),
                       other.assumed_radius_m + other.top_speed_mps * track.sinceAcceptedS(now),
                       static_cast<int>(i)});
  }
}

double PlannerCore::closestSeparation(core::Utime now) const {
  double closest_m = std::numeric_limits<double>::infinity();
  const Track& own = tracks_.at(own_index_);
  for (std::size_t i = 0; i < tracks_.size() && own.seen(); ++i) {
    if (i == own_index_ || !tracks_.at(i).seen()) {
      continue;
    }
    const double centres_m = (tracks_.at(i).positionAt(now) - own.positionAt(now)).norm();
    closest_m = std::min(
        closest_m, centres_m - vehicle().body_radius_m - experiment_.vehicles[i].body_radius_m);
  }
  return closest_m;
}

void PlannerCore::fillPositionCommand(const Eigen::Vector3d& target, core::Command& command) const {
  command.mode = core::CommandMode::kPosition;
  command.position_world_m = room_.clipPosition(target);
  command.heading_world_rad = std::isnan(goal_->heading_world_rad)
                                  ? core::headingOf(tracks_.at(own_index_).state().orientation)
                                  : goal_->heading_world_rad;
}

void PlannerCore::fly(core::Utime now, core::Command& command, Status& status) {
  const Track& own = tracks_.at(own_index_);
  const core::EgoAgent ego = egoAgent(now);
  if (holdsPosition(ego, experiment_.planner)) {
    status.mode = Mode::kAtGoal;
    fillPositionCommand(goal_->position_world_m, command);
    return;
  }
  collectOthers(now);
  status.decision = policy_->decide(ego, others_);
  const PlanarCommand planar = commandFrom(status.decision, ego, experiment_.planner);
  const Eigen::Vector2d velocity = room_.clipVelocity(
      own.state().position_world_m, own.state().velocity_world_mps, planar.velocity_world_mps);
  if ((velocity - planar.velocity_world_mps).norm() > 1e-9) {
    status.reason = "slowed down at the edge of the room";
  }
  command.mode = core::CommandMode::kVelocity;
  command.velocity_world_mps = {velocity.x(), velocity.y(), 0.0};
  command.position_world_m = room_.clipPosition(
      {ego.position_world_m.x(), ego.position_world_m.y(), goal_->position_world_m.z()});
  command.heading_world_rad = planar.heading_world_rad;
  command.heading_rate_radps = planar.heading_rate_radps;
}

bool PlannerCore::finite(const core::Command& command) {
  return command.velocity_world_mps.allFinite() && command.position_world_m.allFinite() &&
         std::isfinite(command.heading_world_rad) && std::isfinite(command.heading_rate_radps);
}

PlannerCore::Tick PlannerCore::report(core::Utime now, core::Utime state_utime,
                                      const Verdict& verdict) {
  const Track& own = tracks_.at(own_index_);
  Tick result;
  Status& status = result.status;
  status.utime = now;
  status.mode = verdict.mode;
  status.reason = verdict.reason;
  status.goal = goal_;
  status.closest_separation_m = closestSeparation(now);
  status.rejected_measurements = tracks_.rejectedMeasurements();
  status.missed_ticks = timer_.missed();
  status.state_age_s =
      own.seen() ? own.sinceAcceptedS(now) : std::numeric_limits<double>::infinity();
  if (goal_ && own.seen()) {
    status.distance_to_goal_m = (goal_->position_world_m.head<2>() - own.positionAt(now)).norm();
  }

  core::Command& command = result.command;
  command.utime = now;
  command.state_utime = state_utime;
  command.vehicle = vehicle().name;
  command.valid_for_s = experiment_.planner.command_valid_s;
  command.position_world_m = own.state().position_world_m;
  command.heading_world_rad = core::headingOf(own.state().orientation);
  switch (verdict.mode) {
    case Mode::kFlying:
      fly(now, command, status);
      break;
    case Mode::kTakingOff:
    case Mode::kAtGoal:
      fillPositionCommand(goal_->position_world_m, command);
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
  const bool moves =
      command.mode == core::CommandMode::kVelocity || command.mode == core::CommandMode::kPosition;
  if (moves) {
    // Decided on a state that is already old: expire so that the vehicle holds when the state is
    // too old.
    const double left_s = experiment_.safety.own_track_hold_s - own.ageS(now);
    if (own.ageS(now) > 0.0) {
      command.valid_for_s = std::min(command.valid_for_s, left_s);
    }
  }
  if (!finite(command)) {
    onRejected();
    status.mode = Mode::kHolding;
    status.reason = "the policy returned something that is not a number";
    command.mode = core::CommandMode::kHold;
    command.velocity_world_mps.setZero();
    command.position_world_m = own.state().position_world_m;
    command.heading_world_rad = core::headingOf(own.state().orientation);
    command.heading_rate_radps = 0.0;
  }
  status.rejected_messages = rejected_messages_;
  return result;
}

PlannerCore::Tick PlannerCore::tick(core::Utime now) {
  applyGoals(now);
  return report(now, now, decideMode(now));
}

PlannerCore::Tick PlannerCore::onSilence(double silence_s) {
  const core::Utime now = gate_.last() + core::toUtime(silence_s);
  if (inTheAir() && silence_s >= experiment_.safety.states_land_s) {
    latch_.fault(Latch::kLand, fmt::format("no vehicle states for {:.0f} ms",
                                           1e3 * experiment_.safety.states_land_s));
  }
  Verdict verdict{Mode::kHolding, "no vehicle states"};
  if (latch_.state() == Latch::kKill) {
    verdict = {Mode::kKilled, latch_.reason()};
  } else if (latch_.state() == Latch::kLand) {
    verdict = {Mode::kLanding, latch_.reason()};
  } else if (!inTheAir()) {
    verdict = {Mode::kOnFloor, "no vehicle states"};
  }
  return report(now, gate_.last(), verdict);
}

Status PlannerCore::waitingStatus() const {
  Status status;
  status.reason = "no vehicle states yet";
  status.rejected_messages = rejected_messages_;
  return status;
}

}  // namespace roundabout::planner
