#include "fleet/coordinator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/config/spacing.h"
#include "fleet/goal_check.h"

namespace roundabout::fleet {

namespace {

constexpr std::int64_t kIdsPerStep = 1000;
constexpr std::int64_t kFirstLiveId = 1'000'000;
constexpr std::size_t kRefusalsKept = 10;
constexpr std::size_t kLongestQueue = 1000;
// Places on the floor are measured; they may seem this much closer than they are.
constexpr double kMeasuring_m = 0.01;

}  // namespace

Coordinator::Coordinator(const config::Experiment& experiment)
    : experiment_(experiment),
      roster_(experiment),
      reader_(experiment),
      file_steps_(reader_.readFile()) {}

void Coordinator::onMission(std::int64_t mission_id, const config::MissionStep& asked) {
  if (asked_.size() >= kLongestQueue) {
    refuse(mission_id, "too many missions at once");
    return;
  }
  asked_.push_back({mission_id, asked});
}

void Coordinator::takeMissions(core::Utime now) {
  for (const Asked& asked : std::exchange(asked_, {})) {
    take(now, asked);
  }
}

void Coordinator::take(core::Utime now, const Asked& asked) {
  const std::int64_t mission_id = asked.mission_id;
  newest_mission_ = std::max(newest_mission_, mission_id);
  if (asked.step.verb == "go_on") {
    goOn(now, mission_id);
    return;
  }
  StepsOrRefusal steps = reader_.read(asked.step);
  if (const auto* refusal = std::get_if<std::string>(&steps)) {
    refuse(mission_id, *refusal);
    return;
  }
  if (phase_ == Phase::kWaiting) {
    refuse(mission_id, "not every planner and vehicle is there yet");
    return;
  }
  if (!failure_.empty() && phase_ == Phase::kLand) {
    refuse(mission_id, "landing after: " + failure_);
    return;
  }
  auto& expanded = std::get<std::vector<Step>>(steps);
  const Verb verb = expanded.front().verb;
  const bool at_once = verb == Verb::kHold || verb == Verb::kLand;
  if (at_once) {
    const std::string why = "dropped by " + asked.step.verb;
    if (live_ && stepping()) {
      refuse(live_step_.mission_id, why);
    }
    drop(why);
    file_finished_ = true;
  }
  if (queue_.size() + expanded.size() > kLongestQueue) {
    refuse(mission_id, fmt::format("more than {} steps are queued", kLongestQueue));
    return;
  }
  for (Step& queued : expanded) {
    queue_.push_back({mission_id, std::move(queued)});
  }
  if (at_once || phase_ == Phase::kIdle || phase_ == Phase::kDone || phase_ == Phase::kFailed) {
    failure_.clear();
    next(now);
  }
}

/// Whatever else was asked for goes on; nothing is flown under this id.
void Coordinator::goOn(core::Utime now, std::int64_t mission_id) {
  if (waitsFor(Event::kGoOn)) {
    stepDone(now);
  } else {
    refuse(mission_id, "nothing waits for go_on");
  }
}

bool Coordinator::waitsFor(Event event) const {
  return stepping() && failure_.empty() && step().verb == Verb::kWaitUntil && step().event == event;
}

/// Forgets what is queued.
void Coordinator::drop(const std::string& why) {
  std::int64_t last = stepping() && live_ ? live_step_.mission_id : 0;
  for (const Queued& queued : std::exchange(queue_, {})) {
    if (queued.mission_id != last) {
      last = queued.mission_id;
      refuse(last, why);
    }
  }
}

void Coordinator::stepDone(core::Utime now) {
  const bool last = queue_.empty() || queue_.front().mission_id != live_step_.mission_id;
  if (live_ && last) {
    finished_mission_ = std::max(finished_mission_, live_step_.mission_id);
  }
  next(now);
}

void Coordinator::refuse(std::int64_t mission_id, const std::string& reason) {
  refusals_.push_back(fmt::format("mission {}: {}", mission_id, reason));
  if (refusals_.size() > kRefusalsKept) {
    refusals_.pop_front();
  }
}

Coordinator::Output Coordinator::tick(const core::StatesFrame& frame) {
  outbox_.clear();
  tick_time_ = last_tick_ > 0 ? frame.utime - last_tick_ : 0;
  last_tick_ = frame.utime;
  roster_.update(frame);
  if (phase_ == Phase::kWaiting) {
    if (roster_.complete()) {
      start(frame.utime);
    }
  } else {
    advance(frame.utime);
  }
  takeMissions(frame.utime);
  repeatGoals(frame.utime);
  return {outbox_, status(frame.utime)};
}

void Coordinator::start(core::Utime now) {
  took_off_ = now;
  std::int64_t known_id = 0;
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    known_id = std::max(known_id, roster_[i].planner.goal_id);
  }
  if (known_id > 0) {
    takeOver(now, known_id);
  } else if (file_steps_.empty()) {
    file_finished_ = true;
    phase_ = Phase::kIdle;
  } else {
    begin(now);
  }
}

void Coordinator::takeOver(core::Utime now, std::int64_t known_id) {
  const auto known_step = static_cast<std::size_t>(known_id / kIdsPerStep);
  if (known_id < kFirstLiveId && known_step >= 1 && known_step <= file_steps_.size()) {
    index_ = known_step - 1;
    resuming_ = true;
    begin(now);
    resuming_ = false;
    return;
  }
  file_finished_ = true;
  if (known_id < kFirstLiveId && !file_steps_.empty() && known_step == file_steps_.size() + 1) {
    fail(now, "the mission had failed before fleet was restarted");
    return;
  }
  // A flight by messages or by another file: its goals stand, and nobody remembers what was queued.
  live_count_ = std::max<std::int64_t>(0, (known_id - kFirstLiveId) / kIdsPerStep) + 1;
  phase_ = Phase::kIdle;
}

void Coordinator::next(core::Utime now) {
  if (!file_finished_ && !live_) {
    ++index_;
    file_finished_ = index_ >= file_steps_.size();
    if (!file_finished_) {
      begin(now);
      return;
    }
  }
  if (!queue_.empty()) {
    live_ = true;
    live_step_ = queue_.front();
    queue_.pop_front();
    ++live_count_;
    begin(now);
    return;
  }
  finish();
}

void Coordinator::finish() {
  const bool flew_the_file = !live_ && !file_steps_.empty();
  if (!flew_the_file || file_steps_.back().verb != Verb::kLand) {
    phase_ = Phase::kIdle;
    return;
  }
  const bool came_down = roster_.anybodyCameDown();
  if (came_down) {
    failure_ = "landed without: " + roster_.whoIsOut();
  }
  phase_ = came_down ? Phase::kFailed : Phase::kDone;
}

std::optional<std::string> Coordinator::cannotBegin(const Step& candidate) const {
  if (needsAir(candidate.verb) && roster_.allOnFloor()) {
    return "all vehicles are on the floor: take off first";
  }
  // What was begun before fleet was restarted goes on.
  if (candidate.verb == Verb::kTakeOff && !resuming_) {
    return tooCloseToTakeOff();
  }
  if (candidate.verb == Verb::kGoTo) {
    for (std::size_t i = 0; i < roster_.size(); ++i) {
      if (i == candidate.vehicle) {
        continue;
      }
      if (auto refusal = tooClose(i, candidate.points_m[0])) {
        return refusal;
      }
    }
  }
  if (candidate.verb == Verb::kFormation && candidate.points_m.size() < roster_.size()) {
    const Assignment assignment = assign(candidate);
    for (std::size_t i = 0; i < roster_.size(); ++i) {
      for (std::size_t j = 0; assignment[i] == kUnassigned && j < candidate.points_m.size(); ++j) {
        if (auto refusal = tooClose(i, candidate.points_m[j])) {
          return fmt::format("there is no point for {}: {}", experiment_.vehicles[i].name,
                             *refusal);
        }
      }
    }
  }
  return std::nullopt;
}

std::optional<std::string> Coordinator::tooCloseToTakeOff() const {
  const double needed_m = config::goalSpacingM(experiment_);
  for (std::size_t j = 1; j < roster_.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const double distance_m = (placeAbove(i) - placeAbove(j)).head<2>().norm();
      if (distance_m < needed_m - kMeasuring_m) {
        return fmt::format("{} and {} are {:.2f} m apart and must be {:.2f} m to take off",
                           experiment_.vehicles[i].name, experiment_.vehicles[j].name, distance_m,
                           needed_m);
      }
    }
  }
  return std::nullopt;
}

std::optional<std::string> Coordinator::tooClose(std::size_t standing,
                                                 const Eigen::Vector3d& point_m) const {
  const double distance_m = (roster_.placeOf(standing) - point_m).head<2>().norm();
  if (distance_m >= config::goalSpacingM(experiment_)) {
    return std::nullopt;
  }
  return fmt::format("the point is {:.2f} m from {}'s goal and must be {:.2f} m", distance_m,
                     experiment_.vehicles[standing].name, config::goalSpacingM(experiment_));
}

void Coordinator::begin(core::Utime now) {
  step_time_ = 0;
  formed_time_ = 0;
  if (auto refusal = cannotBegin(step())) {
    if (live_) {
      refuse(live_step_.mission_id, *refusal);
      next(now);
    } else {
      fail(now, *refusal);
    }
    return;
  }
  switch (step().verb) {
    case Verb::kTakeOff:
      phase_ = Phase::kTakeOff;
      took_off_ = now;
      sendAllUp(now);
      break;
    case Verb::kFormation:
      phase_ = Phase::kGo;
      sendToFormation(now);
      break;
    case Verb::kGoTo:
      phase_ = Phase::kGo;
      setGoal(now, step().vehicle, core::GoalPhase::kGo, step().points_m[0]);
      break;
    case Verb::kHold:
      phase_ = Phase::kHold;
      // On the floor it calls off a take-off.
      roster_.allOnFloor() ? sendAllDown(now) : stay(now);
      break;
    case Verb::kWait:
    case Verb::kWaitUntil:
      phase_ = Phase::kHold;
      break;
    case Verb::kLand:
      phase_ = Phase::kLand;
      sendAllDown(now);
      break;
  }
}

void Coordinator::sendAllUp(core::Utime now) {
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    setGoal(now, i, core::GoalPhase::kTakeOff, placeAbove(i));
  }
}

Eigen::Vector3d Coordinator::placeAbove(std::size_t vehicle) const {
  Eigen::Vector3d above =
      nearestGoal(experiment_, vehicle, roster_[vehicle].state.position_world_m);
  above.z() = experiment_.vehicles[vehicle].height_m;
  return above;
}

Assignment Coordinator::assign(const Step& formation) const {
  const std::vector<Eigen::Vector3d>& points_m = formation.points_m;
  if (experiment_.fleet.assignment == "optimal") {
    if (resuming_) {
      return assignAsReported(formation);
    }
    std::vector<Eigen::Vector3d> places_m;
    for (std::size_t i = 0; i < roster_.size(); ++i) {
      places_m.push_back(roster_[i].state.position_world_m);
    }
    return assignOptimally(places_m, points_m);
  }
  if (experiment_.fleet.assignment == "in_order") {
    return assignInOrder(roster_.size(), points_m.size());
  }
  const std::int64_t number =
      live_ ? kFirstLiveId + live_count_ : static_cast<std::int64_t>(index_);
  return assignAtRandom(roster_.size(), points_m.size(), experiment_.seed,
                        fmt::format("assignment/{}", number));
}

/// The assignment under which the distances that the planners report fit best (least squares):
/// where the vehicles were when it was made is forgotten.
Assignment Coordinator::assignAsReported(const Step& formation) const {
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(formation.points_m.size()),
                                               static_cast<Eigen::Index>(roster_.size()));
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    const double reported_m = roster_[i].planner.distance_to_goal_m;
    for (std::size_t j = 0; std::isfinite(reported_m) && j < formation.points_m.size(); ++j) {
      const double distance_m =
          (roster_[i].state.position_world_m - formation.points_m[j]).head<2>().norm();
      // A vehicle without a point stays where it is, at distance 0.
      cost(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) =
          (distance_m - reported_m) * (distance_m - reported_m) - reported_m * reported_m;
    }
  }
  return core::assignAtLeastCost(cost);
}

void Coordinator::sendToFormation(core::Utime now) {
  const Assignment assignment = assign(step());
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    Eigen::Vector3d position_m = nearestGoal(experiment_, i, roster_.placeOf(i));
    if (assignment[i] != kUnassigned) {
      position_m = step().points_m[assignment[i]];
      if (step().at_own_heights) {
        position_m.z() = experiment_.vehicles[i].height_m;
      }
    }
    setGoal(now, i, core::GoalPhase::kGo, position_m);
  }
}

void Coordinator::stay(core::Utime now) {
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    // Who is on the floor stays there: a planner takes no goal to fly to from it.
    const auto phase = roster_.onFloor(i) ? core::GoalPhase::kLand : core::GoalPhase::kGo;
    setGoal(now, i, phase, nearestGoal(experiment_, i, roster_[i].state.position_world_m));
  }
}

void Coordinator::sendAllDown(core::Utime now) {
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    setGoal(now, i, core::GoalPhase::kLand, roster_[i].state.position_world_m);
  }
}

std::int64_t Coordinator::goalId(std::size_t vehicle) const {
  // The landing after a failure counts as the step after the last.
  const auto file_step = static_cast<std::int64_t>(failure_.empty() ? index_ : file_steps_.size());
  const std::int64_t base =
      live_ ? kFirstLiveId + live_count_ * kIdsPerStep : (file_step + 1) * kIdsPerStep;
  return base + static_cast<std::int64_t>(vehicle);
}

void Coordinator::setGoal(core::Utime now, std::size_t vehicle, core::GoalPhase phase,
                          const Eigen::Vector3d& position_m) {
  core::Goal goal;
  goal.utime = now;
  goal.vehicle = experiment_.vehicles[vehicle].name;
  goal.goal_id = goalId(vehicle);
  goal.position_world_m = position_m;
  goal.heading_world_rad = std::numeric_limits<double>::quiet_NaN();
  goal.phase = phase;
  roster_.setGoal(vehicle, goal);
  outbox_.push_back(goal);
}

void Coordinator::repeatGoals(core::Utime now) {
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    const Roster::Member& member = roster_[i];
    if (member.goal && core::toSeconds(now - member.goal_sent) >= experiment_.fleet.goal_repeat_s) {
      outbox_.push_back(*member.goal);
      roster_.markSent(i, now);
    }
  }
}

bool Coordinator::complete() const {
  const Step& current = step();
  if (current.verb == Verb::kHold || current.verb == Verb::kWait) {
    return core::toSeconds(step_time_) >= current.seconds;
  }
  if (current.verb == Verb::kWaitUntil && current.event != Event::kFormed) {
    return current.event == Event::kTime &&
           core::toSeconds(last_tick_ - took_off_) >= current.seconds;
  }
  if (current.verb == Verb::kLand) {
    return roster_.down();
  }
  if (current.verb == Verb::kGoTo) {
    return roster_.out(current.vehicle) || roster_.atGoal(current.vehicle);
  }
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    if (!roster_.atGoal(i) && !roster_.out(i)) {
      return false;
    }
  }
  return true;
}

void Coordinator::advance(core::Utime now) {
  if (phase_ == Phase::kIdle || phase_ == Phase::kDone || phase_ == Phase::kFailed) {
    return;
  }
  roster_.noteAbsences();
  bool somebody_holds = false;
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    somebody_holds = somebody_holds || roster_.holds(i);
  }
  if (!somebody_holds) {
    step_time_ += tick_time_;
  }
  if (!failure_.empty()) {
    if (roster_.down() || core::toSeconds(step_time_) > experiment_.fleet.step_timeout_s) {
      phase_ = Phase::kFailed;
    }
    return;
  }
  if (roster_.allOut() && step().verb != Verb::kLand) {
    fail(now, "no vehicle is left: " + roster_.whoIsOut());
    return;
  }
  checkStep(now);
}

void Coordinator::checkStep(core::Utime now) {
  const Step& current = step();
  if (current.verb == Verb::kFormation && phase_ == Phase::kHold) {
    formed_time_ += tick_time_;
    if (core::toSeconds(formed_time_) >= current.seconds) {
      stepDone(now);
    }
    return;
  }
  if (complete()) {
    if (current.verb == Verb::kFormation) {
      phase_ = Phase::kHold;
    } else {
      stepDone(now);
    }
    return;
  }
  const bool waits = current.verb == Verb::kHold || current.verb == Verb::kWait ||
                     (current.verb == Verb::kWaitUntil && current.event != Event::kFormed);
  if (!waits && core::toSeconds(step_time_) > experiment_.fleet.step_timeout_s) {
    fail(now, fmt::format("{} was not complete after {:.0f} s: {}",
                          current.name.empty() ? "the step" : "\"" + current.name + "\"",
                          experiment_.fleet.step_timeout_s, roster_.whoIsNotAtGoal()));
  }
}

void Coordinator::fail(core::Utime now, const std::string& reason) {
  drop(reason);
  failure_ = reason;
  file_finished_ = true;
  live_count_ += live_ ? 1 : 0;
  step_time_ = 0;
  phase_ = Phase::kLand;
  sendAllDown(now);
}

bool Coordinator::stepping() const {
  return phase_ == Phase::kTakeOff || phase_ == Phase::kGo || phase_ == Phase::kHold ||
         phase_ == Phase::kLand;
}

FleetStatus Coordinator::status(core::Utime now) const {
  FleetStatus status;
  status.utime = now;
  status.phase = phase_;
  status.num_steps = static_cast<int>(file_steps_.size());
  status.newest_mission_id = newest_mission_;
  status.finished_mission_id = finished_mission_;
  if (stepping() && failure_.empty()) {
    status.formation = step().name;
    status.mission_id = live_ ? live_step_.mission_id : 0;
  }
  if (phase_ != Phase::kWaiting) {
    status.step = std::min(static_cast<int>(index_), status.num_steps - 1);
  }
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    Progress progress;
    progress.goal = roster_[i].goal;
    progress.distance_m = roster_.distanceToGoalM(i);
    progress.at_goal = roster_.atGoal(i);
    progress.planner_alive = roster_.alive(i);
    progress.planner_mode = roster_[i].planner.mode;
    status.vehicles_at_goal += progress.at_goal ? 1 : 0;
    status.vehicles.push_back(progress);
  }
  status.refusals.assign(refusals_.begin(), refusals_.end());
  if (phase_ == Phase::kWaiting) {
    status.reason = waitingStatus().reason;
    return status;
  }
  status.reason = waitsFor(Event::kGoOn) ? "waits for go_on" : failure_;
  if (failure_.empty() && (stepping() || phase_ == Phase::kDone)) {
    const std::string absent = roster_.whoIsOut();
    if (!absent.empty()) {
      status.reason += (status.reason.empty() ? "out: " : "; out: ") + absent;
    }
    for (std::size_t i = 0; stepping() && i < roster_.size(); ++i) {
      if (roster_.holds(i)) {
        status.reason += fmt::format("{}{} holds", status.reason.empty() ? "" : "; ",
                                     experiment_.vehicles[i].name);
      }
    }
  }
  return status;
}

FleetStatus Coordinator::waitingStatus() const {
  FleetStatus status;
  status.num_steps = static_cast<int>(file_steps_.size());
  for (std::size_t i = 0; i < roster_.size(); ++i) {
    Progress progress;
    progress.distance_m = std::numeric_limits<double>::quiet_NaN();
    progress.planner_alive = roster_.everHeardOf(i);
    progress.planner_mode = roster_[i].planner.mode;
    status.vehicles.push_back(progress);
  }
  const std::string missing = roster_.whatIsMissing();
  status.reason = missing.empty() ? "" : "waits for " + missing;
  return status;
}

}  // namespace roundabout::fleet
