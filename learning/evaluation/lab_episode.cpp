#include "learning/evaluation/lab_episode.h"

#include <algorithm>
#include <bit>

#include <spdlog/fmt/fmt.h>

#include "common/core/polygon.h"
#include "common/core/random.h"
#include "learning/evaluation/episode_record.h"
#include "planner/planner_core.h"
#include "sim/mocap_model.h"
#include "sim/sensors/laser_scanners.h"
#include "sim/world.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr core::Utime kStart = core::kMicrosPerSecond;
constexpr double kRoomMargin_m = 10.0;
constexpr double kHeight_m = 1.0;
// Until all hover: they climb one metre at 0.7 m/s.
constexpr double kTakeOff_s = 4.0;

using Policies = std::span<const std::unique_ptr<planner::Policy>>;

config::Experiment describe(const Rules& rules, const TestCase& test_case, const Crew& crew) {
  const Policies policies = crew.policies;
  config::Experiment experiment;
  experiment.file = "lab rules";
  experiment.sim = rules.sim;
  experiment.planner.orca = rules.orca;
  experiment.planner.rate_hz = 1.0 / rules.planning_step_s;
  experiment.planner.command_valid_s = rules.command_valid_s;
  experiment.shield = rules.shield;
  Vector2d low = test_case.agents.front().start_m;
  Vector2d high = low;
  const auto include = [&](const Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  };
  for (const AgentSpec& agent : test_case.agents) {
    include(agent.start_m);
    include(agent.goal_m);
    const Vector2d way = agent.goal_m - agent.start_m;
    config::Vehicle vehicle;
    vehicle.name = fmt::format("agent{}", experiment.vehicles.size());
    vehicle.assumed_radius_m = agent.radius_m;
    vehicle.body_radius_m = rules.body_share * agent.radius_m;
    vehicle.preferred_speed_mps = agent.preferred_speed_mps;
    vehicle.top_speed_mps = std::max(vehicle.top_speed_mps, 2.0 * agent.preferred_speed_mps);
    vehicle.height_m = kHeight_m;
    vehicle.start = config::Start{agent.start_m, std::atan2(way.y(), way.x())};
    vehicle.shielded = crew.isShielded(experiment.vehicles.size());
    if (policies[experiment.vehicles.size()]->needsScan()) {
      vehicle.lidar = config::Lidar();
    }
    experiment.vehicles.push_back(vehicle);
  }
  for (const std::vector<Vector2d>& goals_m : test_case.later_goals_m) {
    std::for_each(goals_m.begin(), goals_m.end(), include);
  }
  for (const core::Polygon& obstacle : test_case.obstacles) {
    std::for_each(obstacle.begin(), obstacle.end(), include);
    experiment.obstacles.push_back(
        {fmt::format("obstacle{}", experiment.obstacles.size()), obstacle});
  }
  experiment.room.min_m << low.array() - kRoomMargin_m, 0.0;
  experiment.room.max_m << high.array() + kRoomMargin_m, 4.0;
  return experiment;
}

// Cases differ in their clocks and losses.
std::uint64_t seedOf(const TestCase& test_case) {
  return std::bit_cast<std::uint64_t>(test_case.agents.front().start_m.x());
}

/// Vehicles, cameras and planners on one clock.
class LabEpisode {
 public:
  LabEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew, Trace* trace)
      : rules_(rules),
        experiment_(describe(rules, test_case, crew)),
        world_(experiment_, kStart),
        mocap_(experiment_, world_.stepUs()),
        scanners_(experiment_),
        record_(rules, test_case, trace),
        random_(seedOf(test_case), "lab"),
        goals_m_(test_case.agents.size()) {
    for (std::size_t i = 0; i < record_.size(); ++i) {
      config::Experiment own = experiment_;
      own.planner.policy = crew.policies[i]->name();
      own.shield.on = crew.isShielded(i);
      planners_.push_back(std::make_unique<planner::PlannerCore>(own, experiment_.vehicles[i].name,
                                                                 crew.policies[i]->twin()));
      const double period_s = rules.synchronised ? 0.0 : rules.planning_step_s;
      clock_leads_.push_back(core::toUtime(random_.uniform(0.0, period_s)));
    }
    mocap_.observe(world_.now(), world_.bodies());
    next_frame_ = world_.now();
  }

  void takeOff() {
    advance(2 * core::toUtime(rules_.planning_step_s));
    for (std::size_t i = 0; i < record_.size(); ++i) {
      send(i, core::GoalPhase::kTakeOff, positionOf(i));
    }
    advance(core::toUtime(kTakeOff_s));
  }

  void fly(std::span<const Vector2d> goals_m) {
    record_.beginLeg(goals_m, position_of_);
    flying_ = true;
    goals_m_.assign(goals_m.begin(), goals_m.end());
    for (std::size_t i = 0; i < record_.size(); ++i) {
      record_[i].collided = touched_[i];
      send(i, core::GoalPhase::kGo, goals_m[i]);
    }
    const core::Utime began = world_.now();
    while (!record_.allDone()) {
      advance(core::toUtime(rules_.planning_step_s));
      judge(core::toSeconds(world_.now() - began));
      record_.endStep(position_of_);
    }
    record_.endLeg();
  }

  const EpisodeRecord& record() const { return record_; }

 private:
  Vector2d positionOf(std::size_t i) const { return world_.bodies()[i].position_world_m.head<2>(); }

  void send(std::size_t i, core::GoalPhase phase, const Vector2d& position_m) {
    core::Goal goal;
    goal.utime = mocap_time_ + clock_leads_[i];
    goal.vehicle = experiment_.vehicles[i].name;
    goal.goal_id = ++last_goal_;
    goal.position_world_m = Vector3d(position_m.x(), position_m.y(), kHeight_m);
    goal.heading_world_rad = std::numeric_limits<double>::quiet_NaN();
    goal.phase = phase;
    planners_[i]->onGoal(goal);
  }

  void advance(core::Utime duration) {
    const core::Utime end = world_.now() + duration;
    while (world_.now() < end) {
      if (world_.now() >= next_frame_ + mocap_.latencyUs()) {
        plan();
      }
      world_.step();
      mocap_.observe(world_.now(), world_.bodies());
      noteSeparation();
    }
  }

  // Every planner acts by a clock of its own, and hears most of what is said.
  void plan() {
    const auto scans = scanners_.sweep(world_.now(), world_.bodies());
    frame_ = mocap_.expose(next_frame_);
    mocap_time_ = next_frame_;
    next_frame_ += mocap_.frameIntervalUs();
    for (const auto& [vehicle, scan] : scans) {
      core::LaserScan heard = scan;
      heard.utime += clock_leads_[vehicle];
      planners_[vehicle]->onScan(heard);
    }
    for (std::size_t i = 0; i < planners_.size(); ++i) {
      if (random_.chance(rules_.loss)) {
        continue;
      }
      frame_.utime = mocap_time_ + clock_leads_[i];
      if (const auto tick = planners_[i]->onFrame(frame_)) {
        send(i, tick->command);
        note(i, tick->status);
      }
    }
  }

  void send(std::size_t i, core::Command command) {
    command.utime -= clock_leads_[i];
    command.state_utime -= clock_leads_[i];
    if (!random_.chance(rules_.loss)) {
      world_.accept(i, command);
    }
    for (std::size_t j = 0; j < planners_.size(); ++j) {
      if (j != i && !random_.chance(rules_.loss)) {
        core::Command heard = command;
        heard.utime += clock_leads_[j];
        heard.state_utime += clock_leads_[j];
        planners_[j]->onOthersCommand(heard);
      }
    }
  }

  void note(std::size_t i, const planner::Status& status) {
    if (flying_ && !record_[i].done()) {
      record_.noteDecision();
      if (status.shield.layer != core::ShieldLayer::kNotAsked) {
        record_.noteLayer(status.shield.layer);
      }
    }
  }

  void noteSeparation() {
    for (std::size_t i = 0; i < record_.size(); ++i) {
      const config::Vehicle& a = experiment_.vehicles[i];
      for (std::size_t j = i + 1; j < record_.size(); ++j) {
        const double distance_m = (positionOf(i) - positionOf(j)).norm();
        const config::Vehicle& b = experiment_.vehicles[j];
        record_.noteGap(distance_m - a.assumed_radius_m - b.assumed_radius_m);
        if (distance_m <= a.body_radius_m + b.body_radius_m) {
          noteTouch(i);
          noteTouch(j);
        }
      }
      for (const config::Obstacle& obstacle : experiment_.obstacles) {
        const double distance_m = core::distanceTo(obstacle.points_m, positionOf(i));
        record_.noteGap(distance_m - a.assumed_radius_m);
        if (distance_m <= a.body_radius_m) {
          noteTouch(i);
        }
      }
    }
  }

  void noteTouch(std::size_t agent) {
    touched_[agent] = true;
    record_[agent].collided = true;
  }

  void judge(double time_s) {
    for (std::size_t i = 0; i < record_.size(); ++i) {
      EpisodeRecord::Agent& agent = record_[i];
      if (agent.time_s > 0.0 && agent.done()) {
        continue;
      }
      agent.time_s = time_s;
      agent.at_goal =
          !agent.collided && (positionOf(i) - goals_m_[i]).norm() <= rules_.goal_distance_m;
      agent.timed_out =
          !agent.at_goal && !agent.collided &&
          time_s >= rules_.time_ratio * agent.straight_time_s + rules_.time_allowance_s;
    }
  }

  const Rules& rules_;
  config::Experiment experiment_;
  sim::World world_;
  sim::MocapModel mocap_;
  sim::LaserScanners scanners_;
  EpisodeRecord record_;
  core::RandomStream random_;  // clocks and losses
  std::vector<Vector2d> goals_m_;
  std::vector<bool> touched_ = std::vector<bool>(goals_m_.size(), false);  // since the take-off
  bool flying_ = false;
  std::vector<std::unique_ptr<planner::PlannerCore>> planners_;
  std::vector<core::Utime> clock_leads_;
  core::StatesFrame frame_;
  core::Utime next_frame_ = 0;
  core::Utime mocap_time_ = 0;
  std::int64_t last_goal_ = 0;
  const EpisodeRecord::PositionOf position_of_ = [this](std::size_t i) { return positionOf(i); };
};

}  // namespace

EpisodeResult runLabEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew,
                            Trace* trace) {
  LabEpisode episode(rules, test_case, crew, trace);
  episode.takeOff();
  flyLegs(test_case, episode.record(),
          [&](std::span<const Vector2d> goals_m) { episode.fly(goals_m); });
  return episode.record().result();
}

}  // namespace roundabout::learning
