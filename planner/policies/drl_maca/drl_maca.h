#pragma once

#include <memory>
#include <optional>

#include "planner/policies/drl_maca/network.h"
#include "planner/policies/drl_maca/scan_stack.h"
#include "planner/policies/table.h"
#include "planner/policy.h"

namespace roundabout::planner {

/// DRLMACA (Long, Fan, Liao, Liu, Zhang, Pan, "Towards Optimally Decentralized Multi-Robot
/// Collision Avoidance via Deep Reinforcement Learning", ICRA 2018): from laser scans to a speed
/// and a turn, the mean of what was learned. Knows nothing of the others but what it scans. Without
/// a scan of its field of view it stands.
class DrlMaca final : public Policy {
 public:
  /// Of planning; turns are rates times this.
  static constexpr double kTimeStepS = 0.1;

  /// with_value: decisions carry the critic's value.
  explicit DrlMaca(std::shared_ptr<const DrlMacaWeights> weights, bool with_value = true);

  Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override;
  bool needsScan() const override { return true; }
  /// It sees them in its scans, as it sees everything.
  bool avoidsObstacles() const override { return true; }
  std::unique_ptr<Policy> twin() const override;
  void reset() override;
  std::string_view name() const override { return "drl_maca"; }

 private:
  DrlMacaNetwork::OwnInputs ownInputs(const core::EgoAgent& ego) const;

  DrlMacaNetwork network_;
  bool with_value_;
  ScanStack stack_;
  std::optional<double> last_heading_rad_;  // in the call before; its own turn rate is not told
};

/// Throws core::StartupError if options.weights is not a file of this architecture.
std::unique_ptr<Policy> makeDrlMaca(const PolicyOptions& options);

}  // namespace roundabout::planner
