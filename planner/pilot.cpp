#include "planner/pilot.h"

#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "common/config/obstacles.h"
#include "common/core/error.h"
#include "planner/command_law.h"

namespace roundabout::planner {

namespace {

// The world of an older scan is another one.
constexpr double kOldestScan_s = 0.3;
// A velocity is not flown that would come too near to the map within this time.
constexpr double kMapLookAhead_s = 1.0;
// Between a body and the map, beside the half cell by which the map may be wrong.
constexpr double kMapMargin_m = 0.05;

}  // namespace

Pilot::Pilot(const config::Experiment& experiment, std::size_t own_index,
             std::unique_ptr<Policy> policy)
    : settings_(experiment.planner),
      max_range_m_(experiment.vehicles[own_index].lidar
                       ? experiment.vehicles[own_index].lidar->max_range_m
                       : 0.0),
      policy_(std::move(policy)),
      obstacles_(config::placesToAvoid(experiment)),
      way_settings_{experiment.vehicles[own_index].body_radius_m, kMapMargin_m} {
  others_.reserve(experiment.vehicles.size());
  if (!obstacles_.empty() && !policy_->avoidsObstacles() && !experiment.shield.on) {
    throw core::StartupError(
        experiment.file, "obstacles",
        fmt::format("none, since the policy {} does not avoid them and the shield is off",
                    policy_->name()),
        fmt::format("{}", obstacles_.size()));
  }
  if (policy_->needsScan() && !experiment.vehicles[own_index].lidar) {
    throw core::StartupError(experiment.file, fmt::format("vehicles[{}].lidar", own_index),
                             fmt::format("one, since the policy {} flies by it", policy_->name()),
                             "none");
  }
}

/// Without ranges if there is none, or none that is new enough.
core::RangeScan Pilot::freshScan(core::Utime now) {
  const core::LaserScan* const scan = scans_.newestBefore(now);
  if (scan == nullptr || core::toSeconds(now - scan->utime) > kOldestScan_s) {
    return {};
  }
  return {scan->first_angle_rad, scan->angle_step_rad, max_range_m_, scan->ranges_m};
}

void Pilot::holdGoal(const Situation& situation, const core::Goal& goal, const RoomGuard& room,
                     core::Command& command) {
  command.mode = core::CommandMode::kPosition;
  command.position_world_m = room.clipPosition(goal.position_world_m);
  command.heading_world_rad = std::isnan(goal.heading_world_rad)
                                  ? core::headingOf(situation.own().state().orientation)
                                  : goal.heading_world_rad;
}

void Pilot::fly(core::Utime now, const Situation& situation, const core::Goal& goal,
                const RoomGuard& room, core::Command& command, Status& status) {
  const core::EgoAgent ego = situation.egoAgent(now, goal);
  if (holdsPosition(ego, settings_)) {
    status.mode = Mode::kAtGoal;
    holdGoal(situation, goal, room, command);
    return;
  }
  situation.collectOthers(now, others_);
  core::Surroundings around(others_);
  around.obstacles = obstacles_;
  if (needsScans()) {
    around.scan = freshScan(now);
  }
  status.decision = policy_->decide(headedFor(ego), around);
  const PlanarCommand planar = commandFrom(status.decision, ego, settings_);
  command.mode = core::CommandMode::kVelocity;
  command.velocity_world_mps << planar.velocity_world_mps, 0.0;
  command.position_world_m = room.clipPosition(
      {ego.position_world_m.x(), ego.position_world_m.y(), goal.position_world_m.z()});
  command.heading_world_rad = planar.heading_world_rad;
  command.heading_rate_radps = planar.heading_rate_radps;
  keepOffMap(ego, command);
}

core::EgoAgent Pilot::headedFor(core::EgoAgent ego) const {
  if (way_finder_) {
    // Without a way it sets off straight, as far as the map lets it.
    ego.goal_world_m =
        way_finder_->nextPlace(ego.position_world_m, ego.goal_world_m).value_or(ego.goal_world_m);
  }
  return ego;
}

void Pilot::keepOffMap(const core::EgoAgent& ego, core::Command& command) const {
  const Eigen::Vector2d wanted_mps = command.velocity_world_mps.head<2>();
  if (!way_finder_ || !wanted_mps.allFinite()) {
    return;
  }
  const Eigen::Vector2d flown_mps =
      way_finder_->maskedVelocity(ego.position_world_m, wanted_mps, kMapLookAhead_s);
  if (flown_mps == wanted_mps) {
    return;
  }
  command.velocity_world_mps.head<2>() = flown_mps;
  command.heading_rate_radps = 0.0;
  if (!flown_mps.isZero()) {
    command.heading_world_rad = std::atan2(flown_mps.y(), flown_mps.x());
  }
}

void Pilot::beginAnew() {
  scans_.clear();
  way_finder_.reset();
  policy_->reset();
}

}  // namespace roundabout::planner
