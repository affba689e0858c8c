#include "planner/pilot.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "common/config/obstacles.h"
#include "common/core/error.h"

namespace roundabout::planner {

namespace {

// The world of an older scan is another one.
constexpr double kOldestScan_s = 0.3;
// A velocity is not flown that would come too near to the map within this time.
constexpr double kMapLookAhead_s = 1.0;
// Between a body and the map where no shield keeps more, beside the half cell by which the map may
// be wrong.
constexpr double kMapMargin_m = 0.05;
// More than the shield keeps: its half-planes must leave the way open that was found.
constexpr double kBesideShield_m = 0.02;
constexpr std::size_t kMostWaitingMaps = 8;
// Of the probability of an action that stands, where the likeliest would hit the map: it leads
// nowhere, but is right for a policy that sees no way.
constexpr float kStandingWorth = 0.2F;
// From a vehicle's centre: nothing farther is reached within a command and braking after it.
constexpr double kNearMap_m = 3.0;

double mapMarginOf(const config::Shield& shield) {
  return shield.on ? std::max(kMapMargin_m, shield.margin_m + kBesideShield_m) : kMapMargin_m;
}

}  // namespace

Pilot::Pilot(const config::Experiment& experiment, std::size_t own_index,
             std::unique_ptr<Policy> policy)
    : settings_(experiment.planner),
      max_range_m_(experiment.vehicles[own_index].lidar
                       ? experiment.vehicles[own_index].lidar->max_range_m
                       : 0.0),
      policy_(std::move(policy)),
      obstacles_(config::placesToAvoid(experiment)),
      way_settings_{experiment.vehicles[own_index].body_radius_m, mapMarginOf(experiment.shield)} {
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
  const PlanarCommand planar = offMap(ego, status.decision);
  command.mode = core::CommandMode::kVelocity;
  command.velocity_world_mps << planar.velocity_world_mps, 0.0;
  command.position_world_m = room.clipPosition(
      {ego.position_world_m.x(), ego.position_world_m.y(), goal.position_world_m.z()});
  command.heading_world_rad = planar.heading_world_rad;
  command.heading_rate_radps = planar.heading_rate_radps;
}

core::EgoAgent Pilot::headedFor(core::EgoAgent ego) {
  next_place_m_.reset();
  if (way_finder_) {
    if (const auto leg = way_finder_->nextLeg(ego.position_world_m, ego.goal_world_m)) {
      next_place_m_ = leg->place_m;
      ego.way_left_m = leg->way_left_m;
    }
  }
  // Without a way it sets off straight, as far as the map lets it.
  ego.goal_world_m = next_place_m_.value_or(ego.goal_world_m);
  return ego;
}

std::span<const core::Polygon> Pilot::mappedNear(const Eigen::Vector2d& place_m) {
  mapped_.clear();
  if (way_finder_) {
    way_finder_->nearestCells(place_m, kNearMap_m, mapped_);
  }
  return mapped_;
}

bool Pilot::hitsMap(const core::EgoAgent& ego, const Eigen::Vector2d& velocity_mps) const {
  return way_finder_ && velocity_mps.allFinite() &&
         !way_finder_->freeBetween(ego.position_world_m,
                                   ego.position_world_m + kMapLookAhead_s * velocity_mps);
}

/// The decision as a command, or what is flown instead of one that would hit the map: of policies
/// with an action table the most probable action that does not, of others the nearest direction.
PlanarCommand Pilot::offMap(const core::EgoAgent& ego, Decision& decision) const {
  PlanarCommand command = commandFrom(decision, ego, settings_);
  if (!hitsMap(ego, command.velocity_world_mps)) {
    return command;
  }
  if (const auto likeliest = likeliestOffMap(ego, decision)) {
    return *likeliest;
  }
  command.velocity_world_mps = way_finder_->maskedVelocity(
      ego.position_world_m, command.velocity_world_mps, kMapLookAhead_s);
  command.heading_rate_radps = 0.0;
  if (!command.velocity_world_mps.isZero()) {
    command.heading_world_rad =
        std::atan2(command.velocity_world_mps.y(), command.velocity_world_mps.x());
  }
  return command;
}

/// Makes the decision the likeliest one that does not hit the map. Rather one that moves than one
/// that stands, unless the policy would hardly do it. Nothing: there is none, or no action table.
std::optional<PlanarCommand> Pilot::likeliestOffMap(const core::EgoAgent& ego,
                                                    Decision& decision) const {
  std::optional<PlanarCommand> likeliest;
  float highest = 0.0F;
  const std::size_t count = std::min(decision.actions.size(), decision.action_probabilities.size());
  for (std::size_t i = 0; i < count; ++i) {
    const bool stands = decision.actions[i].speed_fraction == 0.0;
    const float worth = decision.action_probabilities[i] * (stands ? kStandingWorth : 1.0F);
    if (!(worth > highest)) {
      continue;
    }
    Decision other = decision;
    other.action = static_cast<int>(i);
    other.speed_mps = decision.actions[i].speed_fraction * ego.preferred_speed_mps;
    other.heading_change_rad = decision.actions[i].heading_change_rad;
    const PlanarCommand command = commandFrom(other, ego, settings_);
    if (!hitsMap(ego, command.velocity_world_mps)) {
      highest = worth;
      likeliest = command;
      decision = other;
    }
  }
  return likeliest;
}

void Pilot::onMap(core::Utime utime, OccupancyGrid map) {
  if (waiting_maps_.size() == kMostWaitingMaps) {
    waiting_maps_.pop_back();  // the oldest comes into effect first
  }
  waiting_maps_.push_back({utime, WayFinder(way_settings_, std::move(map))});
}

void Pilot::applyMaps(core::Utime now) {
  for (WaitingMap& waiting : waiting_maps_) {
    if (waiting.utime < now && waiting.utime >= map_utime_) {
      map_utime_ = waiting.utime;
      way_finder_ = std::move(waiting.way_finder);
    }
  }
  std::erase_if(waiting_maps_, [now](const WaitingMap& each) { return each.utime < now; });
}

void Pilot::beginAnew() {
  scans_.clear();
  waiting_maps_.clear();
  way_finder_.reset();
  next_place_m_.reset();
  map_utime_ = 0;
  policy_->reset();
}

}  // namespace roundabout::planner
