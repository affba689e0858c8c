#pragma once

#include <array>
#include <memory>
#include <span>

#include "planner/nn/conv1d.h"
#include "planner/nn/dense.h"

namespace roundabout::planner {

/// Topology of the network of Long et al. (ICRA 2018), as in the third-party implementation that
/// the GA3C-CADRL paper compares with (Acmece/rl-collision-avoidance, model/net.py): two
/// convolutions over stacked scans, a dense layer, one more that sees goal and own speed too.
struct DrlMacaTrunk {
  static constexpr int kScans = 3;
  static constexpr int kBeams = 512;
  static constexpr int kChannels = 32;
  static constexpr int kOwnInputs = 4;  ///< goal x, y; own linear and angular speed
  static constexpr int kWide = 256;
  static constexpr int kNarrow = 128;
  using Conv1 = nn::Conv1d<kBeams, kScans, kChannels, 5, 2, 1>;
  using Conv2 = nn::Conv1d<Conv1::kOutputLength, kChannels, kChannels, 3, 2, 1>;
  static constexpr int kFeatures = Conv2::kOutputLength * kChannels;

  Conv1 conv1;
  Conv2 conv2;
  nn::Dense<kFeatures, kWide> dense1;
  nn::Dense<kWide + kOwnInputs, kNarrow> dense2;
};

/// A trunk for the actor and one for the critic, with their heads. Never changes once loaded.
struct DrlMacaWeights {
  static constexpr int kActorOutputs = 2;

  DrlMacaTrunk actor, critic;
  /// Linear and angular speed before their sigmoid and tanh.
  nn::Kernel<kActorOutputs> actor_kernel =
      nn::Kernel<kActorOutputs>::Zero(DrlMacaTrunk::kNarrow, kActorOutputs);
  nn::Row<kActorOutputs> actor_bias = nn::Row<kActorOutputs>::Zero();
  nn::Row<DrlMacaTrunk::kNarrow> critic_kernel = nn::Row<DrlMacaTrunk::kNarrow>::Zero();
  float critic_bias = 0.0F;
};

/// Evaluates a network on its own scratch memory. Allocates nothing once made.
class DrlMacaNetwork {
 public:
  /// The last scans, oldest first, normalised: range / 6 m - 0.5. [kScans][kBeams].
  using Scans = std::array<std::array<float, DrlMacaTrunk::kBeams>, DrlMacaTrunk::kScans>;
  using OwnInputs = std::array<float, DrlMacaTrunk::kOwnInputs>;

  struct Output {
    double linear_mps = 0.0;     ///< 0 to 1
    double angular_radps = 0.0;  ///< -1 to 1, counter-clockwise
    double value = 0.0;
  };

  explicit DrlMacaNetwork(std::shared_ptr<const DrlMacaWeights> weights);

  Output evaluate(const Scans& scans, const OwnInputs& own);

  const std::shared_ptr<const DrlMacaWeights>& weights() const { return weights_; }

 private:
  using Trunk = DrlMacaTrunk;

  const nn::Row<Trunk::kNarrow>& run(const Trunk& trunk, const OwnInputs& own);

  std::shared_ptr<const DrlMacaWeights> weights_;
  // On the heap: large.
  Trunk::Conv1::Input scans_;
  Trunk::Conv1::Output features1_;
  Trunk::Conv2::Output features2_;
  nn::Row<Trunk::kWide> wide_;
  nn::Row<Trunk::kWide + Trunk::kOwnInputs> joint_;
  nn::Row<Trunk::kNarrow> narrow_;
};

}  // namespace roundabout::planner
