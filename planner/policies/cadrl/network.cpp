#include "planner/policies/cadrl/network.h"

#include <utility>

namespace roundabout::planner {

namespace {

/// shared = joint [A C; B T] + [b c]: the ego's new block before its ReLU, and what is the same for
/// every other agent. others_out = the others' new blocks.
template <int kOwn, int kOther, int kUnits, class Joint, class Others, class Shared,
          class OthersOut>
void apply(const SharedLayer<kOwn, kOther, kUnits>& layer, const Joint& joint, const Others& others,
           Shared& shared, OthersOut& others_out) {
  shared.noalias() = joint * layer.joint;
  shared.rowwise() += layer.bias;
  others_out.noalias() = others * layer.self;
  const Eigen::Index states = joint.rows();
  for (int k = 0; k < kCadrlOthers; ++k) {
    auto block = others_out.middleRows(k * states, states);
    block = (block + shared.template rightCols<kUnits>()).cwiseMax(0.0F);
  }
}

}  // namespace

CadrlNetwork::CadrlNetwork(std::shared_ptr<const CadrlWeights> weights)
    : weights_(std::move(weights)) {}

void CadrlNetwork::normalise(std::span<const JointState> states) {
  const Weights& net = *weights_;
  const auto count = static_cast<Eigen::Index>(states.size());
  joint_inputs_.resize(count, Eigen::NoChange);
  other_inputs_.resize(kCadrlOthers * count, Eigen::NoChange);
  for (Eigen::Index i = 0; i < count; ++i) {
    const JointState& state = states[static_cast<std::size_t>(i)];
    const Eigen::Map<const nn::Row<Weights::kOwnInputs>> own(state.own.data());
    nn::Row<Weights::kOtherInputs> sum = nn::Row<Weights::kOtherInputs>::Zero();
    for (int k = 0; k < kCadrlOthers; ++k) {
      const Eigen::Map<const nn::Row<Weights::kOtherInputs>> other(
          state.others[static_cast<std::size_t>(k)].data());
      auto input = other_inputs_.row(k * count + i);
      input = (other - net.other_mean).cwiseQuotient(net.other_deviation);
      sum += input;
    }
    joint_inputs_.row(i) << (own - net.own_mean).cwiseQuotient(net.own_deviation), sum;
  }
}

std::span<const float> CadrlNetwork::evaluate(std::span<const JointState> states) {
  constexpr int kUnits = Weights::kUnits;
  const Weights& net = *weights_;
  const auto count = static_cast<Eigen::Index>(states.size());
  const auto others = [count](auto& batch, int k) { return batch.middleRows(k * count, count); };

  normalise(states);
  apply(net.layer1, joint_inputs_, other_inputs_, shared_, others_a_);
  joint_.resize(count, Eigen::NoChange);
  joint_.leftCols<kUnits>() = shared_.leftCols<kUnits>().cwiseMax(0.0F);
  joint_.rightCols<kUnits>() = others(others_a_, 0) + others(others_a_, 1) + others(others_a_, 2);

  apply(net.layer2, joint_, others_a_, shared_, others_b_);
  joint_.leftCols<kUnits>() = shared_.leftCols<kUnits>().cwiseMax(0.0F);
  joint_.rightCols<kUnits>() =
      others(others_b_, 0).cwiseMax(others(others_b_, 1)).cwiseMax(others(others_b_, 2));

  hidden_.noalias() = joint_ * net.layer3.kernel;
  hidden_.rowwise() += net.layer3.bias;
  hidden_ = hidden_.cwiseMax(0.0F);
  values_.noalias() = hidden_ * net.value_kernel.transpose();
  values_ = (values_.array() + net.value_bias) * net.value_deviation + net.value_mean;
  return {values_.data(), states.size()};
}

}  // namespace roundabout::planner
