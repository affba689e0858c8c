#include "planner/shield/shield.h"

#include <algorithm>

#include "planner/shield/brake_constraints.h"
#include "planner/shield/breaker.h"
#include "planner/shield/evasion.h"
#include "planner/shield/look_ahead.h"
#include "planner/shield/step_aside.h"

namespace roundabout::planner::shield {

using Eigen::Vector2d;

class Shield::Impl {
 public:
  explicit Impl(const ShieldParameters& parameters)
      : parameters_(parameters),
        constraints_(parameters_),
        look_ahead_(parameters_),
        evasion_(parameters_),
        breaker_(parameters_) {}

  ShieldDecision decide(const Ego& ego, std::span<const Neighbour> neighbours,
                        const Statics& statics, const Vector2d& wanted_mps, double now_s) {
    scene_.build(ego, neighbours, parameters_);
    constraints_.build(ego, neighbours, statics);
    ShieldDecision decision;
    decision.wanted_world_mps = wanted_mps;
    decision.predicted_gap_m = constraints_.smallestGapM();
    Vector2d meant = ego.parked ? park(ego, neighbours, wanted_mps, decision)
                                : fly(ego, statics, wanted_mps, now_s, decision);
    if (const auto away = evasion_.instead(ego, neighbours, constraints_, meant)) {
      meant = *away;
      decision.layer = decision.layer == Layer::kNone ? Layer::kLookAhead : decision.layer;
    }
    decision.velocity_world_mps =
        constraints_.nearest(meant, parameters_.keeps_heading && decision.layer == Layer::kNone);
    if (decision.velocity_world_mps != meant && decision.layer == Layer::kNone) {
      decision.layer = constraints_.worstIsStatic(meant) ? Layer::kStatic : Layer::kHard;
    }
    return decision;
  }

  void reset() {
    evasion_.reset();
    breaker_.reset();
  }

  const ShieldParameters& parameters() const { return parameters_; }

 private:
  Vector2d fly(const Ego& ego, const Statics& statics, const Vector2d& wanted_mps, double now_s,
               ShieldDecision& decision) {
    const bool alone = scene_.discs().empty() && statics.obstacles.empty();
    if (parameters_.breaker && !alone) {
      if (const auto plan = breaker_.update(ego, scene_, statics, now_s)) {
        decision.layer = Layer::kBreaker;
        decision.asks_for_way = plan->asks_for_way;
        return plan->velocity_mps;
      }
    }
    if (parameters_.look_ahead_s > 0.0) {
      if (const auto instead = look_ahead_.instead(ego, scene_, constraints_, wanted_mps)) {
        decision.layer = Layer::kLookAhead;
        return *instead;
      }
    }
    return wanted_mps;
  }

  Vector2d park(const Ego& ego, std::span<const Neighbour> neighbours, const Vector2d& wanted_mps,
                ShieldDecision& decision) {
    breaker_.reset();
    if (!parameters_.steps_aside) {
      return wanted_mps;
    }
    const std::optional<Vector2d> aside = placeAside(ego, scene_, neighbours, parameters_);
    if (!aside) {
      return wanted_mps;
    }
    decision.layer = Layer::kStepAside;
    // Whoever is parked in its way makes room in turn.
    decision.asks_for_way = true;
    const Vector2d velocity = parameters_.step_aside_gain_per_s * (*aside - scene_.position());
    return velocity * std::min(1.0, ego.preferred_speed_mps / std::max(velocity.norm(), 1e-9));
  }

  const ShieldParameters parameters_;
  BrakeConstraints constraints_;
  LookAhead look_ahead_;
  Evasion evasion_;
  Breaker breaker_;
  Scene scene_;
};

Shield::Shield(const ShieldParameters& parameters) : impl_(std::make_unique<Impl>(parameters)) {}
Shield::~Shield() = default;
Shield::Shield(Shield&&) noexcept = default;
Shield& Shield::operator=(Shield&&) noexcept = default;

ShieldDecision Shield::decide(const Ego& ego, std::span<const Neighbour> neighbours,
                              const Statics& statics, const Vector2d& wanted_world_mps,
                              double now_s) {
  return impl_->decide(ego, neighbours, statics, wanted_world_mps, now_s);
}

void Shield::reset() { impl_->reset(); }

const ShieldParameters& Shield::parameters() const { return impl_->parameters(); }

}  // namespace roundabout::planner::shield
