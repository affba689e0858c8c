#include "planner/shield/shield.h"

#include <algorithm>

#include "planner/shield/brake_constraints.h"

namespace roundabout::planner::shield {

using Eigen::Vector2d;

const char* nameOf(Layer layer) {
  switch (layer) {
    case Layer::kNone:
      return "none";
    case Layer::kHard:
      return "hard";
    case Layer::kStatic:
      return "static";
    case Layer::kLookAhead:
      return "look_ahead";
    case Layer::kBreaker:
      return "breaker";
    case Layer::kStepAside:
      return "step_aside";
  }
  return "unknown";
}

class Shield::Impl {
 public:
  explicit Impl(const ShieldParameters& parameters)
      : parameters_(parameters), constraints_(parameters_) {}

  ShieldDecision decide(const Ego& ego, std::span<const Neighbour> neighbours,
                        const Statics& statics, const Vector2d& wanted_mps, double /*now_s*/) {
    ShieldDecision decision;
    decision.wanted_world_mps = wanted_mps;
    constraints_.build(ego, neighbours, statics);
    decision.velocity_world_mps = constraints_.nearest(wanted_mps);
    decision.predicted_gap_m = constraints_.smallestGapM();
    if (decision.velocity_world_mps != wanted_mps) {
      decision.layer = constraints_.worstIsStatic(wanted_mps) ? Layer::kStatic : Layer::kHard;
    }
    return decision;
  }

  void reset() {}

  const ShieldParameters& parameters() const { return parameters_; }

 private:
  const ShieldParameters parameters_;
  BrakeConstraints constraints_;
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
