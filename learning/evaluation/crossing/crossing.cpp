#include "learning/evaluation/crossing/crossing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/core/error.h"
#include "planner/planner_core.h"
#include "sim/mocap_model.h"
#include "sim/sensors/laser_scanners.h"
#include "sim/sensors/odometer.h"
#include "sim/world.h"

namespace roundabout::learning {

namespace {

constexpr core::Utime kStart = core::kMicrosPerSecond;

Eigen::Vector2d goalOf(const config::Experiment& experiment) {
  for (const config::MissionStep& step : experiment.mission) {
    if (!step.points_m.empty()) {
      return step.points_m.front().head<2>();
    }
  }
  throw core::StartupError(experiment.file, "mission", "a step with a point to drive to", "none");
}

const config::Experiment& withLidar(const config::Experiment& experiment) {
  if (!experiment.vehicles.front().lidar) {
    throw core::StartupError(experiment.file, "vehicles[0].lidar", "one, to see people by", "none");
  }
  return experiment;
}

/// One robot, its sensors and its planner on one clock.
class Crossing {
 public:
  Crossing(const config::Experiment& experiment, const CrossingCast& cast, CrossingTrace* trace)
      : experiment_(withLidar(experiment)),
        trace_(trace),
        robot_(experiment_.vehicles.front()),
        goal_m_(goalOf(experiment_)),
        world_(experiment_, kStart, cast.steering),
        mocap_(experiment_, world_.stepUs()),
        scanners_(experiment_),
        odometers_(experiment_, world_.bodies()),
        eyes_(cast.eyes(experiment_, robot_.name)),
        planner_(experiment_, robot_.name, cast.policy()),
        next_frame_(kStart),
        believed_m_(truth()) {
    mocap_.observe(world_.now(), odometers_.believed(world_.bodies()));
  }

  CrossingResult run() {
    const double straight_m = (truth() - goal_m_).norm();
    const core::Utime give_up = kStart + core::toUtime(experiment_.fleet.step_timeout_s);
    while (world_.now() < give_up && !result_.reached) {
      frame();
      result_.reached = (believed_m_ - goal_m_).norm() <= experiment_.fleet.at_goal_distance_m;
    }
    result_.off_goal_m = (truth() - goal_m_).norm();
    result_.time_s = core::toSeconds(world_.now() - kStart);
    if (result_.reached) {
      const double least_s =
          (straight_m - experiment_.fleet.at_goal_distance_m) / robot_.preferred_speed_mps;
      result_.extra_time_s = result_.time_s - least_s;
    }
    result_.closest_m = world_.encounters().closestM();
    for (const sim::Encounter& encounter : world_.encounters().all()) {
      ++(encounter.byVehicle() ? result_.collisions_by_robot : result_.collisions_by_person);
    }
    if (!world_.encounters().all().empty()) {
      result_.first_collision = world_.encounters().all().front();
      result_.first_collision_s = core::toSeconds(result_.first_collision->begin - kStart);
    }
    result_.collisions_with_things = static_cast<int>(world_.contacts().all().size());
    return result_;
  }

 private:
  Eigen::Vector2d truth() const { return world_.bodies().front().position_world_m.head<2>(); }

  // As sim::SimNode does it: the sweep of now goes out before the frame, which is as old as the
  // cameras are slow.
  void frame() {
    while (world_.now() < next_frame_ + mocap_.latencyUs()) {
      world_.step();
      odometers_.step(world_.wheels(), experiment_.sim.step_s);
      mocap_.observe(world_.now(), odometers_.believed(world_.bodies()));
    }
    for (const auto& [vehicle, scan] :
         scanners_.sweep(world_.now(), world_.bodies(), world_.people())) {
      if (vehicle == 0) {
        eyes_->onScan(scan, world_.people());
        if (planner_.needsScans()) {
          planner_.onScan(scan);
        }
      }
    }
    core::StatesFrame states = mocap_.expose(next_frame_);
    next_frame_ += mocap_.frameIntervalUs();
    for (core::VehicleState& state : states.vehicles) {
      state.last_seen = state.tracked ? states.utime : state.last_seen;
    }
    eyes_->onFrame(states);
    while (const auto tracks = eyes_->takeTracks()) {
      planner_.onTracks(*tracks);
    }
    if (const auto map = eyes_->takeMap()) {
      planner_.onMap(*map);
    }
    if (states.vehicles.front().tracked) {
      believed_m_ = states.vehicles.front().position_world_m.head<2>();
    }
    sendGoal(states.utime);
    if (const auto tick = planner_.onFrame(states)) {
      world_.accept(0, odometers_.asDriven(0, tick->command, world_.bodies()));
      note(tick->status);
      record();
    }
  }

  void sendGoal(core::Utime now) {
    if (goal_sent_) {
      return;
    }
    core::Goal goal;
    goal.utime = now;
    goal.vehicle = robot_.name;
    goal.goal_id = 1;
    goal.position_world_m << goal_m_, robot_.height_m;
    goal.heading_world_rad = std::numeric_limits<double>::quiet_NaN();
    goal.phase = core::GoalPhase::kGo;
    planner_.onGoal(goal);
    goal_sent_ = true;
  }

  void note(const planner::Status& status) {
    ++result_.ticks;
    result_.ticks_blind = status.ticks_without_tracks;
    result_.ticks_shielded = status.shield.interventions;
  }

  void record() {
    if (trace_ == nullptr) {
      return;
    }
    const sim::BodyState& body = world_.bodies().front();
    CrossingTrace::Moment& moment = trace_->moments.emplace_back();
    moment.time_s = core::toSeconds(world_.now() - kStart);
    moment.robot_m = body.position_world_m.head<2>();
    moment.heading_rad = core::headingOf(body.orientation);
    for (const sim::Pedestrian& person : world_.people()) {
      moment.people.push_back({person.id, person.position_m});
    }
    if (world_.encounters().all().size() > trace_->collisions_m.size()) {
      trace_->collisions_m.resize(world_.encounters().all().size(), moment.robot_m);
    }
    trace_->goal_m = goal_m_;
  }

  const config::Experiment experiment_;
  CrossingTrace* const trace_;
  const config::Vehicle& robot_;
  const Eigen::Vector2d goal_m_;
  sim::World world_;
  sim::MocapModel mocap_;
  sim::LaserScanners scanners_;
  sim::Odometers odometers_;
  std::unique_ptr<Eyes> eyes_;
  planner::PlannerCore planner_;
  core::Utime next_frame_;
  Eigen::Vector2d believed_m_;  // where VEHICLE_STATES says that it is
  bool goal_sent_ = false;
  CrossingResult result_;
};

}  // namespace

void requireCrossing(const config::Experiment& experiment, const CrossingCast& cast) {
  static_cast<void>(Crossing(experiment, cast, nullptr));
}

CrossingResult runCrossing(const config::Experiment& experiment, const CrossingCast& cast,
                           CrossingTrace* trace) {
  return Crossing(experiment, cast, trace).run();
}

CrossingSummary summarise(std::span<const CrossingResult> results) {
  CrossingSummary summary;
  summary.runs = static_cast<int>(results.size());
  std::vector<double> extra_s;
  std::vector<double> closest_m;
  double ticks = 0.0;
  double blind = 0.0;
  double shielded = 0.0;
  for (const CrossingResult& each : results) {
    summary.reached += each.reached ? 1 : 0;
    summary.runs_hit_by_robot += each.collisions_by_robot > 0 ? 1 : 0;
    summary.runs_hit_by_person += each.collisions_by_person > 0 ? 1 : 0;
    summary.runs_hit_things += each.collisions_with_things > 0 ? 1 : 0;
    closest_m.push_back(each.closest_m);
    ticks += each.ticks;
    blind += each.ticks_blind;
    shielded += each.ticks_shielded;
    if (each.reached) {
      extra_s.push_back(each.extra_time_s);
    }
  }
  const auto quantile = [](std::vector<double>& values, double share) {
    std::sort(values.begin(), values.end());
    const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5);
    return values[at];
  };
  if (!closest_m.empty()) {
    summary.median_closest_m = quantile(closest_m, 0.5);
    summary.closest_m = closest_m.front();
  }
  if (!extra_s.empty()) {
    summary.p90_extra_s = quantile(extra_s, 0.9);
    summary.mean_extra_s =
        std::accumulate(extra_s.begin(), extra_s.end(), 0.0) / static_cast<double>(extra_s.size());
  }
  if (ticks > 0.0) {
    summary.blind_share = blind / ticks;
    summary.shielded_share = shielded / ticks;
  }
  return summary;
}

}  // namespace roundabout::learning
