#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "planner/planner_core.h"

namespace roundabout::planner {

/// A policy that does what the test says and remembers what it was shown.
class ScriptedPolicy final : public Policy {
 public:
  struct Script {
    Decision decision{.speed_mps = 0.5, .heading_change_rad = 0.0};
    core::EgoAgent ego;
    std::vector<core::OtherAgent> others;
    std::vector<core::Polygon> obstacles;
    std::vector<float> ranges_m;
    double max_range_m = 0.0;
    bool avoids_obstacles = true;
    bool needs_scan = false;
    int calls = 0;
    int resets = 0;
  };

  explicit ScriptedPolicy(std::shared_ptr<Script> script) : script_(std::move(script)) {}

  Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override {
    script_->ego = ego;
    script_->others.assign(around.others.begin(), around.others.end());
    script_->obstacles.assign(around.obstacles.begin(), around.obstacles.end());
    script_->ranges_m.assign(around.scan.ranges_m.begin(), around.scan.ranges_m.end());
    script_->max_range_m = around.scan.max_range_m;
    ++script_->calls;
    return script_->decision;
  }
  bool avoidsObstacles() const override { return script_->avoids_obstacles; }
  bool needsScan() const override { return script_->needs_scan; }
  void reset() override { ++script_->resets; }
  std::unique_ptr<Policy> twin() const override {
    return std::make_unique<ScriptedPolicy>(script_);
  }
  std::string_view name() const override { return "scripted"; }

 private:
  std::shared_ptr<Script> script_;
};

inline config::Experiment threeVehicles() {
  config::Experiment experiment;
  experiment.file = "test";
  experiment.room.min_m = {-5.0, -5.0, 0.0};
  experiment.room.max_m = {5.0, 5.0, 3.0};
  for (const char* name : {"hex1", "hex2", "hex3"}) {
    config::Vehicle vehicle;
    vehicle.name = name;
    experiment.vehicles.push_back(vehicle);
  }
  return experiment;
}

/// The world around the planner of hex1: frames at 200 Hz in which everybody stays where the test
/// put them.
class FakeFlight {
 public:
  static constexpr core::Utime kFrame = 5'000;

  explicit FakeFlight(config::Experiment described = threeVehicles(),
                      std::shared_ptr<ScriptedPolicy::Script> its_script =
                          std::make_shared<ScriptedPolicy::Script>())
      : experiment(std::move(described)),
        script(std::move(its_script)),
        core(experiment, "hex1", std::make_unique<ScriptedPolicy>(script)) {
    const double x[] = {0.0, 3.0, -3.0};
    for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
      core::VehicleState state;
      state.name = experiment.vehicles[i].name;
      state.position_world_m = {x[i % 3], 0.0, 0.0};
      state.tracked = true;
      vehicles.push_back(state);
    }
  }

  /// Sends frames for `seconds`; returns the last tick's result. Frames continue where the last
  /// call ended.
  PlannerCore::Tick run(double seconds) {
    PlannerCore::Tick last;
    const core::Utime end = now + core::toUtime(seconds);
    while (now < end) {
      now += kFrame;
      if (auto tick = frame()) {
        last = *tick;
        ticks.push_back(*tick);
      }
    }
    return last;
  }

  std::optional<PlannerCore::Tick> frame() {
    core::StatesFrame states;
    states.utime = now;
    states.frame_number = ++frame_number_;
    states.vehicles = vehicles;
    for (core::VehicleState& vehicle : states.vehicles) {
      vehicle.last_seen = vehicle.tracked ? now : 0;
    }
    return core.onFrame(states);
  }

  void goal(core::GoalPhase phase, const Eigen::Vector3d& position_m, std::int64_t id = 1) {
    core.onGoal({.utime = now,
                 .vehicle = "hex1",
                 .goal_id = id,
                 .position_world_m = position_m,
                 .heading_world_rad = std::numeric_limits<double>::quiet_NaN(),
                 .phase = phase});
  }

  void order(core::SafetyOrderKind kind, const std::string& vehicle = "") {
    core.onOrder({.utime = now, .vehicle = vehicle, .order = kind});
  }

  /// Takes off and is sent to a goal 4 m ahead.
  void flyTo(const Eigen::Vector3d& goal_m) {
    run(0.1);
    goal(core::GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
    run(0.2);
    own().position_world_m.z() = 0.13;  // climbs in steps that a track can follow
    for (double z = 0.13; z < 1.0; z += 0.1) {
      own().position_world_m.z() = z;
      run(0.005);
    }
    own().position_world_m.z() = 1.0;
    run(0.1);
    goal(core::GoalPhase::kGo, goal_m, 2);
    run(0.2);
  }

  core::VehicleState& own() { return vehicles[0]; }

  config::Experiment experiment;
  std::shared_ptr<ScriptedPolicy::Script> script;
  PlannerCore core;
  std::vector<core::VehicleState> vehicles;
  std::vector<PlannerCore::Tick> ticks;
  core::Utime now = 1'000'000;

 private:
  std::int64_t frame_number_ = 0;
};

}  // namespace roundabout::planner
