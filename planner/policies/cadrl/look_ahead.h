#pragma once

#include <array>
#include <memory>
#include <span>

#include "common/core/agent.h"
#include "planner/policies/cadrl/candidates.h"
#include "planner/policies/cadrl/network.h"

namespace roundabout::planner {

/// Chooses a velocity: each candidate's reward on the way plus the network's value of where it
/// leads after about a second, others going straight on (Chen et al. 2017, section III).
class LookAhead {
 public:
  struct Choice {
    Candidate candidate;
    double value = 0.0;
  };

  explicit LookAhead(std::shared_ptr<const CadrlWeights> weights);

  /// others: one to kCadrlOthers, farthest first.
  Choice choose(const core::EgoAgent& ego, std::span<const core::OtherAgent> others);

  const std::shared_ptr<const CadrlWeights>& weights() const { return network_.weights(); }

 private:
  /// Where a candidate leads.
  struct Outlook {
    double reward = 0.0;  ///< on the way
    double value = 0.0;   ///< from there on; 0 after a collision
  };

  void judgeWays(const core::EgoAgent& ego, std::span<const core::OtherAgent> others);
  void judgeEnds(const core::EgoAgent& ego, std::span<const core::OtherAgent> others);

  CadrlNetwork network_;
  double duration_s_ = 0.0;
  std::array<Candidate, kCandidates> candidates_;
  std::array<Outlook, kCandidates> outlooks_;
  // Of the candidates whose end the network has to judge.
  std::size_t judged_count_ = 0;
  std::array<std::size_t, kCandidates> judged_;
  std::array<JointState, kCandidates> states_;
};

}  // namespace roundabout::planner
