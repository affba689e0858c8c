#pragma once

#include <memory>
#include <vector>

#include "planner/policies/cadrl/look_ahead.h"
#include "planner/policies/table.h"
#include "planner/policy.h"

namespace roundabout::planner {

/// SA-CADRL (Chen, Everett, Liu, How, "Socially Aware Motion Planning with Deep Reinforcement
/// Learning", IROS 2017) without a passing side, as the GA3C-CADRL paper compares with it. Sees the
/// three nearest others, whose velocity is the mean of what it was in this call and in the last.
class Cadrl final : public Policy {
 public:
  explicit Cadrl(std::shared_ptr<const CadrlWeights> weights);

  Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override;
  std::unique_ptr<Policy> twin() const override;
  void reset() override { remembered_.clear(); }
  std::string_view name() const override { return "cadrl"; }

 private:
  struct Remembered {
    int id;
    Eigen::Vector2d velocity_world_mps;
  };
  struct Neighbour {
    double gap_cm;  // rounded
    double orthogonal_m;
    const core::OtherAgent* agent;
  };

  void collectNearest(const core::EgoAgent& ego, std::span<const core::OtherAgent> others);
  Eigen::Vector2d meanVelocity(const core::OtherAgent& other) const;
  void remember(std::span<const core::OtherAgent> others);

  LookAhead look_ahead_;
  std::vector<Remembered> remembered_;  // of the last call
  std::vector<Neighbour> neighbours_;
  std::vector<core::OtherAgent> nearest_;  // farthest first, with their mean velocities
};

/// Throws core::StartupError if options.weights is not a file of this architecture.
std::unique_ptr<Policy> makeCadrl(const PolicyOptions& options);

}  // namespace roundabout::planner
