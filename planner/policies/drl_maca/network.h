#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

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
  static constexpr int kPlaces = Conv2::kOutputLength;
  static constexpr int kFeatures = kPlaces * kChannels;
  /// A beam that hits nothing, normalised.
  static constexpr float kFreeBeam = 0.5F;

  Conv1 conv1;
  Conv2 conv2;
  nn::Dense<kFeatures, kWide> dense1;
  nn::Dense<kWide + kOwnInputs, kNarrow> dense2;

  /// What places [0, row) of free beams add to the first dense layer. [kPlaces + 1, kWide]. Most
  /// beams hit nothing, and what they add is the same every time.
  Eigen::Matrix<double, Eigen::Dynamic, kWide, Eigen::RowMajor> free_sums;

  /// Makes free_sums from the layers.
  void prepare();
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

/// Evaluates a network on its own scratch memory. Allocates nothing once made. Places of the second
/// convolution from which only free beams are seen cost nothing.
class DrlMacaNetwork {
 public:
  /// The last scans, oldest first, normalised: range / 6 m - 0.5. [kScans][kBeams].
  using Scans = std::array<std::array<float, DrlMacaTrunk::kBeams>, DrlMacaTrunk::kScans>;
  using OwnInputs = std::array<float, DrlMacaTrunk::kOwnInputs>;

  struct Output {
    double linear_mps = 0.0;                                  ///< 0 to 1
    double angular_radps = 0.0;                               ///< -1 to 1, counter-clockwise
    double value = std::numeric_limits<double>::quiet_NaN();  ///< if asked for
  };

  explicit DrlMacaNetwork(std::shared_ptr<const DrlMacaWeights> weights);

  /// with_value: the critic too, which costs as much as the actor.
  Output evaluate(const Scans& scans, const OwnInputs& own, bool with_value);

  const std::shared_ptr<const DrlMacaWeights>& weights() const { return weights_; }

 private:
  using Trunk = DrlMacaTrunk;

  /// Places [begin, end) of the second convolution.
  struct Places {
    int begin;
    int end;
  };

  void findBusyPlaces(const Scans& scans);
  const nn::Row<Trunk::kNarrow>& run(const Trunk& trunk, const OwnInputs& own);

  std::shared_ptr<const DrlMacaWeights> weights_;
  // On the heap: large.
  Trunk::Conv1::Input scans_;
  std::vector<Places> busy_;
  Trunk::Conv1::Output features1_;
  Trunk::Conv2::Output features2_;
  nn::Row<Trunk::kWide> wide_;
  nn::Row<Trunk::kWide + Trunk::kOwnInputs> joint_;
  nn::Row<Trunk::kNarrow> narrow_;
};

}  // namespace roundabout::planner
