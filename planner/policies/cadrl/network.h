#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "planner/nn/dense.h"

namespace roundabout::planner {

/// The fields of a joint state, in their order. Frame: origin at the ego, x ("parallel") towards
/// its goal. m, m/s, rad. presence: 1 moves, 2 stands, 0 nobody (the other fields then repeat the
/// first other agent's).
inline constexpr std::array<std::string_view, 7> kCadrlOwnFields = {
    "distance_to_goal",  "preferred_speed",     "speed", "heading",
    "velocity_parallel", "velocity_orthogonal", "radius"};
inline constexpr std::array<std::string_view, 8> kCadrlOtherFields = {"velocity_parallel",
                                                                      "velocity_orthogonal",
                                                                      "position_parallel",
                                                                      "position_orthogonal",
                                                                      "radius",
                                                                      "combined_radius",
                                                                      "gap",
                                                                      "presence"};
/// So many others does the network see.
inline constexpr int kCadrlOthers = 3;

/// One input of the value network, not normalised.
struct JointState {
  std::array<float, kCadrlOwnFields.size()> own;
  std::array<std::array<float, kCadrlOtherFields.size()>, kCadrlOthers> others;
};

/// A layer of one block of units for the ego and one for each other agent, which treats all others
/// alike: own' = relu(own A + sum_k other_k B + b), other_k' = relu(own C + other_k S +
/// sum_(j != k) other_j T + c).
template <int kOwn, int kOther, int kUnits>
struct SharedLayer {
  /// [A C; B T]: from the ego and from the sum of all others, to the ego and to each other.
  nn::Kernel<2 * kUnits> joint = nn::Kernel<2 * kUnits>::Zero(kOwn + kOther, 2 * kUnits);
  /// S - T: T is in the sum already.
  nn::Kernel<kUnits> self = nn::Kernel<kUnits>::Zero(kOther, kUnits);
  nn::Row<2 * kUnits> bias = nn::Row<2 * kUnits>::Zero();  ///< b, c
};

/// Topology and parameters of SA-CADRL's value network (Chen, Everett, Liu, How, IROS 2017): two
/// shared layers, the maximum over the others, a dense layer, one number. Never changes once
/// loaded: agents share it.
struct CadrlWeights {
  static constexpr int kOwnInputs = static_cast<int>(kCadrlOwnFields.size());
  static constexpr int kOtherInputs = static_cast<int>(kCadrlOtherFields.size());
  static constexpr int kUnits = 50;

  nn::Row<kOwnInputs> own_mean, own_deviation;
  nn::Row<kOtherInputs> other_mean, other_deviation;
  float value_mean = 0.0F, value_deviation = 1.0F;
  SharedLayer<kOwnInputs, kOtherInputs, kUnits> layer1;
  SharedLayer<kUnits, kUnits, kUnits> layer2;
  nn::Dense<2 * kUnits, kUnits> layer3;
  nn::Row<kUnits> value_kernel = nn::Row<kUnits>::Zero();
  float value_bias = 0.0F;
};

/// Evaluates many joint states at once on its own scratch memory. Allocates nothing.
class CadrlNetwork {
 public:
  static constexpr int kMaxStates = 47;

  explicit CadrlNetwork(std::shared_ptr<const CadrlWeights> weights);

  /// The value of each of at most kMaxStates states; valid until the next call.
  std::span<const float> evaluate(std::span<const JointState> states);

  const std::shared_ptr<const CadrlWeights>& weights() const { return weights_; }

 private:
  using Weights = CadrlWeights;
  template <int kColumns, int kRows = kMaxStates>
  using Batch = Eigen::Matrix<float, Eigen::Dynamic, kColumns, Eigen::RowMajor, kRows, kColumns>;

  void normalise(std::span<const JointState> states);

  std::shared_ptr<const Weights> weights_;
  // In joint batches a row is the ego's block and the sum of the others'; in the others' batches
  // all first others come first, then all second ones, then all third ones.
  Batch<Weights::kOwnInputs + Weights::kOtherInputs> joint_inputs_;
  Batch<Weights::kOtherInputs, kCadrlOthers * kMaxStates> other_inputs_;
  Batch<2 * Weights::kUnits> shared_, joint_;
  Batch<Weights::kUnits, kCadrlOthers * kMaxStates> others_a_, others_b_;
  Batch<Weights::kUnits> hidden_;
  Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxStates, 1> values_;
};

}  // namespace roundabout::planner
