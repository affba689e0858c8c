#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/angles.h"
#include "common/core/polygon.h"
#include "common/core/random.h"
#include "planner/planner_node.h"
#include "roundabout_msgs/planner_status_t.hpp"
#include "sim/sim_node.h"

namespace roundabout::planner {

/// Decides by a function of what it sees.
class FunctionPolicy final : public Policy {
 public:
  using Function = std::function<Decision(const core::EgoAgent&, const core::Surroundings&)>;

  explicit FunctionPolicy(Function function) : function_(std::move(function)) {}
  Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override {
    return function_(ego, around);
  }
  std::unique_ptr<Policy> twin() const override {
    return std::make_unique<FunctionPolicy>(function_);
  }
  std::string_view name() const override { return "function"; }

 private:
  Function function_;
};

inline Decision toward(const core::EgoAgent& ego, const Eigen::Vector2d& place_m) {
  const Eigen::Vector2d way = place_m - ego.position_world_m;
  return {
      .speed_mps = ego.preferred_speed_mps,
      .heading_change_rad = core::wrapToPi(std::atan2(way.y(), way.x()) - ego.heading_world_rad)};
}

inline std::unique_ptr<Policy> straightToTheGoal() {
  return std::make_unique<FunctionPolicy>([](const core::EgoAgent& ego, const core::Surroundings&) {
    return toward(ego, ego.goal_world_m);
  });
}

/// Flies at whoever is nearest.
inline std::unique_ptr<Policy> chaser() {
  return std::make_unique<FunctionPolicy>(
      [](const core::EgoAgent& ego, const core::Surroundings& around) {
        Eigen::Vector2d nearest = ego.goal_world_m;
        double closest_m = std::numeric_limits<double>::infinity();
        for (const core::OtherAgent& other : around.others) {
          const double apart_m = (other.position_world_m - ego.position_world_m).norm();
          if (apart_m < closest_m) {
            closest_m = apart_m;
            nearest = other.position_world_m;
          }
        }
        return toward(ego, nearest);
      });
}

/// Another direction every tick.
inline std::unique_ptr<Policy> drunkard(std::uint64_t seed) {
  return std::make_unique<FunctionPolicy>(
      [random = std::make_shared<core::RandomStream>(seed, "drunkard")](const core::EgoAgent& ego,
                                                                        const core::Surroundings&) {
        return Decision{.speed_mps = ego.preferred_speed_mps,
                        .heading_change_rad = random->uniform(-std::numbers::pi, std::numbers::pi)};
      });
}

/// `count` multirotors on a circle, in a room of 12 x 12 m.
inline config::Experiment circleOf(std::size_t count, double radius_m) {
  config::Experiment experiment;
  experiment.file = "test";
  experiment.room.min_m = {-6.0, -6.0, 0.0};
  experiment.room.max_m = {6.0, 6.0, 3.0};
  for (std::size_t i = 0; i < count; ++i) {
    const double angle =
        2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    config::Vehicle vehicle;
    vehicle.name = "hex" + std::to_string(i + 1);
    vehicle.preferred_speed_mps = 1.0;
    vehicle.start = config::Start{radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)),
                                  core::wrapToPi(angle + std::numbers::pi)};
    experiment.vehicles.push_back(vehicle);
  }
  return experiment;
}

/// Loses a share of the states and commands that another bus hears.
class LossyBus final : public bus::Bus {
 public:
  LossyBus(std::unique_ptr<bus::Bus> bus, double loss, std::uint64_t seed)
      : bus_(std::move(bus)), loss_(loss), random_(seed, "loss") {}

  void publish(const std::string& channel, std::span<const std::byte> payload) override {
    bus_->publish(channel, payload);
  }
  void subscribe(const std::string& channel, Handler handler) override {
    bus_->subscribe(channel, lossy(std::move(handler)));
  }
  void subscribePrefix(const std::string& prefix, Handler handler) override {
    bus_->subscribePrefix(prefix, lossy(std::move(handler)));
  }
  int handle(std::chrono::milliseconds timeout) override { return bus_->handle(timeout); }

 private:
  Handler lossy(Handler handler) {
    return [this, handler = std::move(handler)](const bus::Received& received) {
      const bool may_be_lost = received.channel == bus::kStatesChannel ||
                               received.channel.starts_with(bus::commandChannel(""));
      if (!may_be_lost || !random_.chance(loss_)) {
        handler(received);
      }
    };
  }

  std::unique_ptr<bus::Bus> bus_;
  double loss_;
  core::RandomStream random_;
};

/// The simulator and everybody's planner, as processes are but in one thread: each has its own bus
/// on one network. Whoever is in the air hears only what goes over the wires.
class ShieldedFlight {
 public:
  using MakePolicy = std::function<std::unique_ptr<Policy>(std::size_t vehicle)>;

  ShieldedFlight(const config::Experiment& experiment, const MakePolicy& make, double loss = 0.0)
      : experiment_(experiment),
        lab_(network_),
        sim_bus_(std::make_unique<bus::MemoryBus>(network_), loss, 0) {
    statuses.resize(experiment.vehicles.size());
    commands.resize(experiment.vehicles.size());
    for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
      const std::string& name = experiment.vehicles[i].name;
      buses_.push_back(
          std::make_unique<LossyBus>(std::make_unique<bus::MemoryBus>(network_), loss, i + 1));
      planners_.push_back(std::make_unique<PlannerNode>(experiment, name, make(i), *buses_.back()));
      const auto ignore = [](const bus::DecodeError&) {};
      bus::subscribe<roundabout_msgs::planner_status_t>(
          lab_, bus::plannerStatusChannel(name),
          [this, i](const auto& status) { statuses[i].push_back(status); }, ignore);
      bus::subscribe<roundabout_msgs::command_t>(
          lab_, bus::commandChannel(name),
          [this, i](const auto& command) { commands[i].push_back(command); }, ignore);
    }
    sim_ = std::make_unique<sim::SimNode>(experiment, sim_bus_, 1'000'000);
  }

  void run(double seconds) {
    const core::Utime end = sim_->nextFrameUtime() + core::toUtime(seconds);
    while (sim_->nextFrameUtime() < end) {
      sim_->advance();
      now_ = sim_->publishFrame();
      for (const auto& each : buses_) {
        if (each != nullptr) {
          each->handle(std::chrono::milliseconds(0));
        }
      }
      sim_bus_.handle(std::chrono::milliseconds(0));
      lab_.handle(std::chrono::milliseconds(0));
      look();
    }
  }

  void takeOff() {
    run(0.1);
    for (std::size_t i = 0; i < experiment_.vehicles.size(); ++i) {
      send(i, core::GoalPhase::kTakeOff, place(i));
    }
    run(3.5);
  }
  void goTo(std::size_t vehicle, const Eigen::Vector2d& place_m) {
    send(vehicle, core::GoalPhase::kGo, place_m);
  }
  void land(std::size_t vehicle) { send(vehicle, core::GoalPhase::kLand, place(vehicle)); }
  void order(core::SafetyOrderKind kind, const std::string& vehicle = "") {
    const core::SafetyOrder order{.utime = now_, .vehicle = vehicle, .order = kind};
    bus::publish(lab_, bus::kSafetyOrderChannel, bus::toMessage(order));
  }
  void killPlanner(std::size_t vehicle) {
    planners_[vehicle].reset();
    buses_[vehicle].reset();
  }

  Eigen::Vector2d place(std::size_t vehicle) const {
    return sim_->world().bodies()[vehicle].position_world_m.head<2>();
  }
  double heightOf(std::size_t vehicle) const {
    return sim_->world().bodies()[vehicle].position_world_m.z();
  }
  bool isNear(std::size_t vehicle, const Eigen::Vector2d& place_m, double within_m = 0.2) const {
    return (place(vehicle) - place_m).norm() < within_m;
  }
  /// Between bodies, in truth, so far. m.
  double closestM() const { return sim_->report().closest_m; }
  /// The same as seen from above, whatever their heights.
  double closestInPlanM() const { return closest_in_plan_m_; }
  /// Between bodies and walls, obstacles or no-fly zones, in truth, so far. m.
  double closestStaticM() const { return closest_static_m_; }
  int interventions(std::size_t vehicle) const {
    return statuses[vehicle].back().shield_interventions;
  }
  bus::MemoryBus& lab() { return lab_; }
  core::Utime now() const { return now_; }

  std::vector<std::vector<roundabout_msgs::planner_status_t>> statuses;  // of each vehicle
  std::vector<std::vector<roundabout_msgs::command_t>> commands;

 private:
  void send(std::size_t vehicle, core::GoalPhase phase, const Eigen::Vector2d& place_m) {
    const config::Vehicle& described = experiment_.vehicles[vehicle];
    core::Goal goal;
    goal.utime = now_;
    goal.vehicle = described.name;
    goal.goal_id = ++goals_;
    goal.position_world_m << place_m, described.height_m;
    goal.heading_world_rad = std::numeric_limits<double>::quiet_NaN();
    goal.phase = phase;
    bus::publish(lab_, bus::goalChannel(described.name), bus::toMessage(goal));
  }

  void look() {
    const auto bodies = sim_->world().bodies();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Eigen::Vector2d place_m = bodies[i].position_world_m.head<2>();
      const double wall_m = std::min((place_m - experiment_.room.min_m.head<2>()).minCoeff(),
                                     (experiment_.room.max_m.head<2>() - place_m).minCoeff());
      double nearest_m = wall_m;
      for (const auto* list : {&experiment_.obstacles, &experiment_.no_fly_zones}) {
        for (const config::Obstacle& obstacle : *list) {
          nearest_m = std::min(nearest_m, core::distanceTo(obstacle.points_m, place_m));
        }
      }
      for (std::size_t j = 0; j < i; ++j) {
        const double apart_m = (place(j) - place_m).norm();
        closest_in_plan_m_ =
            std::min(closest_in_plan_m_, apart_m - experiment_.vehicles[i].body_radius_m -
                                             experiment_.vehicles[j].body_radius_m);
      }
      closest_static_m_ =
          std::min(closest_static_m_, nearest_m - experiment_.vehicles[i].body_radius_m);
    }
  }

  config::Experiment experiment_;
  std::shared_ptr<bus::MemoryNetwork> network_ = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus lab_;
  LossyBus sim_bus_;
  std::vector<std::unique_ptr<LossyBus>> buses_;
  std::vector<std::unique_ptr<PlannerNode>> planners_;
  std::unique_ptr<sim::SimNode> sim_;
  core::Utime now_ = 0;
  std::int64_t goals_ = 0;
  double closest_in_plan_m_ = std::numeric_limits<double>::infinity();
  double closest_static_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace roundabout::planner
