#pragma once

#include <memory>
#include <optional>

#include "planner/observation.h"
#include "planner/policies/ga3c_cadrl/network.h"
#include "planner/policies/ga3c_cadrl/stall_breaker.h"
#include "planner/policies/table.h"
#include "planner/policy.h"

namespace roundabout::planner {

/// GA3C-CADRL (Everett, Chen, How, IEEE Access 2021): flies the most probable of eleven actions,
/// unless it has stalled and its weight file says what to do then.
class Ga3cCadrl final : public Policy {
 public:
  explicit Ga3cCadrl(std::shared_ptr<const Ga3cCadrlWeights> weights);

  Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override;
  std::unique_ptr<Policy> twin() const override {
    return std::make_unique<Ga3cCadrl>(network_.weights());
  }
  void reset() override;
  std::string_view name() const override { return "ga3c_cadrl"; }

 private:
  ObservationEncoder encoder_;
  Ga3cCadrlNetwork network_;
  std::optional<StallBreaker> stall_breaker_;
};

/// Throws core::StartupError if options.weights is not a file of this architecture.
std::unique_ptr<Policy> makeGa3cCadrl(const PolicyOptions& options);

}  // namespace roundabout::planner
