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
// The world of an older scan is another one.
constexpr double kOldestScan_s = 0.3;
// A take-off is straight up, give or take the drift since the fleet looked.
constexpr double kTakeOffReach_m = 0.5;
// Year 2200: a stamp beyond it is corrupt.
constexpr core::Utime kNoSuchTime = 7'258'118'400'000'000;

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

std::string noStatesReason(const config::Safety& safety) {
  return fmt::format("no vehicle states for {:.0f} ms", 1e3 * safety.states_land_s);
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
            experiment.safety.reaction_s) {
  others_.reserve(experiment.vehicles.size());
  for (const config::Obstacle& obstacle : experiment.obstacles) {
    obstacles_.push_back(obstacle.points_m);
  }
  if (!obstacles_.empty() && !policy_->avoidsObstacles()) {
    throw core::StartupError(
        experiment.file, "obstacles",
        fmt::format("none, since the policy {} does not avoid them", policy_->name()),
        fmt::format("{}", obstacles_.size()));
  }
  if (policy_->needsScan() && !this->vehicle().lidar) {
    throw core::StartupError(experiment.file, fmt::format("vehicles[{}].lidar", own_index_),
                             fmt::format("one, since the policy {} flies by it", policy_->name()),
                             "none");
  }
}

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
  } else if (motors_on_ &&
             core::toSeconds(frame.utime - before) >= experiment_.safety.states_land_s) {
    latch_.fault(Latch::kLand, noStatesReason(experiment_.safety));
  }
  rejected_messages_ += tracks_.update(frame);
  if (!timer_.due(frame.utime)) {
    return std::nullopt;
  }
  return tick(frame.utime);
}

/// The states' time went back: nothing from before can be compared with what comes.
void PlannerCore::beginAnew() {
  tracks_ = TrackTable(experiment_);
  timer_ = core::TickTimer(experiment_.planner.rate_hz);
  first_frame_ = 0;
  placed_ = false;
  resumed_ = false;
  pending_goals_.clear();
  goal_.reset();
  scans_.clear();
  policy_->reset();
}

const char* PlannerCore::onGoal(const core::Goal& goal) {
  const char* reason = nullptr;
  if (goal.vehicle != vehicle().name) {
    reason = "of another vehicle";
  } else if (goal.utime < 0 || (started() && goal.utime > gate_.last() + core::kFarAhead)) {
    reason = "its time stamp is corrupt";
  } else if (goal_ && goal.utime < goal_->utime) {
    reason = "older than the goal before it";
  } else if (goal.phase != core::GoalPhase::kLand && room_.mustLand(goal.position_world_m)) {
    reason = "outside the room";
  } else if (goal.phase != core::GoalPhase::kLand && config::flies(vehicle()) &&
             goal.position_world_m.z() <= experiment_.safety.airborne_height_m) {
    reason = "too low to fly at";
  }
  if (reason != nullptr) {
    onRejected();
    return reason;
  }
  pending_goals_.push_back(goal);
  pending_goals_.back().position_world_m = room_.clipPosition(goal.position_world_m);
  return nullptr;
}

const char* PlannerCore::onOrder(const core::SafetyOrder& order) {
  if (!order.vehicle.empty() && order.vehicle != vehicle().name) {
    const bool known = std::any_of(
        experiment_.vehicles.begin(), experiment_.vehicles.end(),
        [&](const config::Vehicle& candidate) { return candidate.name == order.vehicle; });
    rejected_messages_ += known ? 0 : 1;
    return known ? nullptr : "for a vehicle that the experiment does not have";
  }
  const bool resume = order.order == core::SafetyOrderKind::kResume;
  const bool no_such_time = order.utime >= kNoSuchTime;
  if (resume && (order.utime < last_order_ || no_such_time)) {
    onRejected();
    latch_.remark(no_such_time ? "a resume with a corrupt stamp was refused"
                               : "a resume older than the last order was refused");
    return "a resume that is older than the last order, or corrupt";
  }
  if (resume && order.utime > 0 && order.utime <= last_resume_) {
    return nullptr;  // repeated: it lifts nothing that was latched since
  }
  if (resume) {
    last_resume_ = order.utime;
    resumed_ = resumed_ || started();
  }
  // What makes the vehicle safer is obeyed whatever its stamp, but an old order makes nothing less
  // safe: a hold that is repeated until everybody holds must not end a landing ordered since.
  if (order.utime > 0 && order.utime < last_order_) {
    latch_.raise(order.order);
    return nullptr;
  }
  if (!no_such_time) {
    last_order_ = order.utime;
    obeyed_order_ = order.utime;
  }
  latch_.order(order.order);
  return nullptr;
}

const char* PlannerCore::onScan(const core::LaserScan& scan) {
  if (scan.utime < 0 || (started() && scan.utime > gate_.last() + core::kFarAhead)) {
    onRejected();
    return "its time stamp is corrupt";
  }
  scans_.add(scan);
  return nullptr;
}

/// Without ranges if there is none, or none that is new enough.
core::RangeScan PlannerCore::freshScan(core::Utime now) {
  const core::LaserScan* const scan = scans_.newestBefore(now);
  if (scan == nullptr || core::toSeconds(now - scan->utime) > kOldestScan_s) {
    return {};
  }
  return {scan->first_angle_rad, scan->angle_step_rad, vehicle().lidar->max_range_m,
          scan->ranges_m};
}

void PlannerCore::applyGoals(core::Utime now) {
  const auto ready = [&](const core::Goal& goal) { return goal.utime < now; };
  for (const core::Goal& goal : pending_goals_) {
    if (ready(goal) && (!goal_ || goal.utime >= goal_->utime)) {
      applyGoal(goal);
    }
  }
  std::erase_if(pending_goals_, ready);
}

void PlannerCore::applyGoal(const core::Goal& goal) {
  const Track& own = tracks_.at(own_index_);
  const bool is_new = !goal_ || goal_->goal_id != goal.goal_id || goal_->phase != goal.phase;
  if (is_new && goal.phase == core::GoalPhase::kTakeOff && own.seen()) {
    const double away_m = awayFrom(goal);
    if (away_m > kTakeOffReach_m) {
      onRejected();
      refused_take_off_ = fmt::format("a take-off goal {:.1f} m away was refused", away_m);
      return;
    }
  }
  refused_take_off_.clear();
  if (!goal_ && goal.utime < first_frame_ && !resumed_) {
    latch_.fault(Latch::kHold, "restarted during a flight; needs a resume");
  }
  if (is_new) {
    landing_done_ = false;
    policy_->reset();
  }
  goal_ = goal;
}

bool PlannerCore::inTheAir() const {
  const Track& own = tracks_.at(own_index_);
  return own.seen() && config::flies(vehicle()) &&
         own.state().position_world_m.z() - experiment_.room.min_m.z() >
             experiment_.safety.airborne_height_m;
}

double PlannerCore::awayFrom(const core::Goal& goal) const {
  const Eigen::Vector3d& own = tracks_.at(own_index_).state().position_world_m;
  return (goal.position_world_m - own).head<2>().norm();
}

bool PlannerCore::atRestOnFloor() const {
  const Track& own = tracks_.at(own_index_);
  return own.seen() && !inTheAir() && own.state().velocity_world_mps.norm() < kAtRest_mps;
}

void PlannerCore::noteMotors(Mode mode) {
  if (inTheAir() || mode == Mode::kTakingOff) {
    motors_on_ = config::flies(vehicle());
  } else if (mode == Mode::kOnFloor || mode == Mode::kLanded || mode == Mode::kKilled) {
    motors_on_ = false;
  }
}

void PlannerCore::latchFaults(core::Utime now) {
  const config::Safety& safety = experiment_.safety;
  const Track& own = tracks_.at(own_index_);
  if (!own.seen()) {
    return;
  }
  if (!placed_ && inTheAir()) {
    latch_.fault(Latch::kHold, "restarted in the air; needs a resume");
  }
  placed_ = true;
  // The next tick is one period away: land now if the limit would pass before it.
  const double period_s = core::toSeconds(timer_.periodUs());
  const double unseen_s = own.sinceAcceptedS(now);
  if (motors_on_ && unseen_s + period_s > safety.own_track_land_s) {
    latch_.fault(Latch::kLand, fmt::format("not tracked for {:.0f} ms", 1e3 * unseen_s));
  }
  if (inTheAir() && room_.mustLand(own.state().position_world_m)) {
    latch_.fault(Latch::kLand,
                 fmt::format("more than {:.1f} m outside the room", safety.room_land_margin_m));
  }
}

std::string PlannerCore::lostNeighbour(core::Utime now) const {
  const config::Safety& safety = experiment_.safety;
  const Eigen::Vector2d own = tracks_.at(own_index_).positionAt(now);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Track& other = tracks_.at(i);
    if (i == own_index_) {
      continue;
    }
    if (!other.seen()) {
      return experiment_.vehicles[i].name + " was never tracked";
    }
    const double distance_m = std::min((other.state().position_world_m.head<2>() - own).norm(),
                                       (other.positionAt(now) - own).norm());
    if (other.ageS(now) > safety.other_track_lost_s &&
        distance_m <= safety.other_track_hold_radius_m) {
      return experiment_.vehicles[i].name + " is near and not tracked";
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
      return land(latch_.reason());
    case Latch::kHold:
      return {Mode::kHolding, latch_.reason()};
    case Latch::kNone:
      break;
  }
  // Landing is the safest there is, also for a vehicle that cannot be seen.
  if (goal_ && goal_->phase == core::GoalPhase::kLand) {
    return land("");
  }
  if (!own.seen()) {
    return {Mode::kWaiting, "own vehicle was never tracked"};
  }
  if (own.lost()) {
    return {Mode::kHolding, "own track is lost"};
  }
  if (own.ageS(now) >= experiment_.safety.own_track_hold_s) {
    return {Mode::kHolding, "own vehicle is not tracked"};
  }
  if (const std::string lost = lostNeighbour(now); !lost.empty()) {
    return {motors_on_ ? Mode::kHolding : Mode::kOnFloor, lost};
  }
  return obeyGoal(now);
}

PlannerCore::Verdict PlannerCore::land(const std::string& reason) {
  landing_done_ = !inTheAir() && (landing_done_ || atRestOnFloor());
  return {landing_done_ ? Mode::kLanded : Mode::kLanding, reason};
}

PlannerCore::Verdict PlannerCore::obeyGoal(core::Utime now) {
  if (!goal_) {
    return inTheAir()                  ? Verdict{Mode::kHolding, "in the air without a goal"}
           : refused_take_off_.empty() ? Verdict{Mode::kOnFloor, "no goal yet"}
                                       : Verdict{Mode::kOnFloor, refused_take_off_};
  }
  const double height_m = tracks_.at(own_index_).state().position_world_m.z();
  if (goal_->phase == core::GoalPhase::kTakeOff) {
    if (config::flies(vehicle()) && !inTheAir() && awayFrom(*goal_) > kTakeOffReach_m) {
      return {Mode::kOnFloor, fmt::format("the take-off goal is {:.1f} m away", awayFrom(*goal_))};
    }
    const bool reached = !config::flies(vehicle()) ||
                         std::abs(height_m - goal_->position_world_m.z()) < kHeightReached_m;
    return {reached ? Mode::kAtGoal : Mode::kTakingOff, ""};
  }
  if (config::flies(vehicle()) && !inTheAir()) {
    return {Mode::kOnFloor, refused_take_off_.empty()
                                ? "on the floor: a take-off must come before go"
                                : refused_take_off_};
  }
  if (needsScans() && freshScan(now).ranges_m.empty()) {
    return {Mode::kHolding, "no laser scan"};
  }
  return {Mode::kFlying, refused_take_off_};
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
    // Who is lost for good grows no more: those who are near hold.
    const double unseen_s =
        std::min(track.sinceAcceptedS(now), experiment_.safety.other_track_lost_s);
    others_.push_back({track.positionAt(now), track.state().velocity_world_mps.head<2>(),
                       other.assumed_radius_m + other.top_speed_mps * unseen_s,
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
  const core::EgoAgent ego = egoAgent(now);
  if (holdsPosition(ego, experiment_.planner)) {
    status.mode = Mode::kAtGoal;
    fillPositionCommand(goal_->position_world_m, command);
    return;
  }
  collectOthers(now);
  core::Surroundings around(others_);
  around.obstacles = obstacles_;
  if (needsScans()) {
    around.scan = freshScan(now);
  }
  status.decision = policy_->decide(ego, around);
  const PlanarCommand planar = commandFrom(status.decision, ego, experiment_.planner);
  const Eigen::Vector2d velocity =
      room_.clipVelocity(ego.position_world_m, ego.velocity_world_mps, planar.velocity_world_mps);
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
  const Verdict verdict = decideMode(now);
  noteMotors(verdict.mode);
  return report(now, now, verdict);
}

PlannerCore::Tick PlannerCore::onSilence(double silence_s) {
  const core::Utime now = gate_.last() + core::toUtime(silence_s);
  if (motors_on_ && silence_s >= experiment_.safety.states_land_s) {
    latch_.fault(Latch::kLand, noStatesReason(experiment_.safety));
  }
  const bool lands = latch_.state() == Latch::kLand || (latch_.state() == Latch::kNone && goal_ &&
                                                        goal_->phase == core::GoalPhase::kLand);
  Verdict verdict{Mode::kHolding, "no vehicle states"};
  if (killed()) {
    verdict = {Mode::kKilled, latch_.reason()};
  } else if (!motors_on_) {
    verdict = {Mode::kOnFloor, "no vehicle states"};
  } else if (lands) {
    verdict = {Mode::kLanding, latch_.reason()};
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
