#include "sim/pedestrians/policy_steering.h"

#include <cmath>
#include <memory>
#include <utility>

#include "planner/policies/table.h"

namespace roundabout::sim {

namespace {

class PolicySteering final : public Steering {
 public:
  explicit PolicySteering(std::unique_ptr<planner::Policy> policy) : policy_(std::move(policy)) {}

  Eigen::Vector2d velocity(const core::EgoAgent& person, std::span<const core::OtherAgent> others,
                           std::size_t vehicles, double cooperation,
                           std::span<const core::Polygon> obstacles) override {
    core::Surroundings around(cooperation > 0.5 ? others : others.first(others.size() - vehicles));
    around.obstacles = obstacles;
    const planner::Decision decision = policy_->decide(person, around);
    const double course_rad = person.heading_world_rad + decision.heading_change_rad;
    return std::isfinite(decision.speed_mps) && std::isfinite(course_rad)
               ? Eigen::Vector2d(decision.speed_mps *
                                 Eigen::Vector2d(std::cos(course_rad), std::sin(course_rad)))
               : Eigen::Vector2d(Eigen::Vector2d::Zero());
  }

 private:
  std::unique_ptr<planner::Policy> policy_;
};

}  // namespace

SteeringFactory steeringFor(const config::Experiment& experiment) {
  if (experiment.pedestrians.policy == "social_force" || experiment.pedestrians.count == 0) {
    return [] { return std::make_unique<SocialForce>(); };
  }
  planner::PolicyOptions options;
  options.weights = planner::weightsOf(experiment.pedestrians.policy);
  options.orca = experiment.planner.orca;
  options.where = experiment.file + ": pedestrians.policy";
  options.with_value = false;
  const std::shared_ptr<planner::Policy> policy =
      planner::makePolicy(experiment.pedestrians.policy, options);
  return [policy] { return std::make_unique<PolicySteering>(policy->twin()); };
}

}  // namespace roundabout::sim
