#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"

#include <cmath>
#include <limits>
#include <utility>

#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::planner {

Ga3cCadrl::Ga3cCadrl(std::shared_ptr<const Ga3cCadrlWeights> weights)
    : encoder_(weights->max_others, weights->others_order), network_(std::move(weights)) {
  if (network_.weights()->stall) {
    stall_breaker_.emplace(*network_.weights()->stall);
  }
}

void Ga3cCadrl::reset() {
  if (stall_breaker_) {
    stall_breaker_->reset();
  }
}

Decision Ga3cCadrl::decide(const core::EgoAgent& ego, const core::Surroundings& around) {
  const Observation& observation = encoder_.encode(ego, around.others);
  const Ga3cCadrlNetwork::Output output = network_.evaluate(observation);
  // Inputs beyond all reason overflow; the caller must not fly what comes out.
  const bool sound = std::isfinite(output.probabilities[0]);
  const int chosen = sound && stall_breaker_
                         ? stall_breaker_->choose(ego, output.probabilities, output.best_action)
                         : output.best_action;
  const DiscreteAction& action = kActions[static_cast<std::size_t>(chosen)];
  Decision decision;
  decision.speed_mps = sound ? action.speed_fraction * ego.preferred_speed_mps
                             : std::numeric_limits<double>::quiet_NaN();
  decision.heading_change_rad = action.heading_change_rad;
  decision.action = chosen;
  decision.value = output.value;
  decision.action_probabilities = output.probabilities;
  decision.actions = kActions;
  decision.neighbours_used = static_cast<int>(observation.others.size());
  return decision;
}

std::unique_ptr<Policy> makeGa3cCadrl(const PolicyOptions& options) {
  return std::make_unique<Ga3cCadrl>(readGa3cCadrlWeights(options.weights));
}

}  // namespace roundabout::planner
