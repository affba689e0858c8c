#include "planner/policies/drl_maca/network.h"

#include <cmath>
#include <utility>

namespace roundabout::planner {

namespace {

constexpr int kPadding = 1;

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

}  // namespace

DrlMacaNetwork::DrlMacaNetwork(std::shared_ptr<const DrlMacaWeights> weights)
    : weights_(std::move(weights)),
      scans_(Trunk::Conv1::makeInput()),
      features1_(Trunk::Conv1::makeOutput(kPadding)),
      features2_(Trunk::Conv2::makeOutput()) {}

const nn::Row<DrlMacaTrunk::kNarrow>& DrlMacaNetwork::run(const Trunk& trunk,
                                                          const OwnInputs& own) {
  trunk.conv1.applyRelu(scans_, features1_, kPadding);
  trunk.conv2.applyRelu(features1_, features2_);
  const Eigen::Map<const nn::Row<Trunk::kFeatures>> flat(features2_.data());
  trunk.dense1.applyRelu(flat, wide_);
  joint_ << wide_, Eigen::Map<const nn::Row<Trunk::kOwnInputs>>(own.data());
  trunk.dense2.applyRelu(joint_, narrow_);
  return narrow_;
}

DrlMacaNetwork::Output DrlMacaNetwork::evaluate(const Scans& scans, const OwnInputs& own) {
  for (int scan = 0; scan < Trunk::kScans; ++scan) {
    scans_.col(scan).segment<Trunk::kBeams>(kPadding) =
        Eigen::Map<const Eigen::Matrix<float, Trunk::kBeams, 1>>(
            scans[static_cast<std::size_t>(scan)].data());
  }
  const DrlMacaWeights& net = *weights_;
  const nn::Row<DrlMacaWeights::kActorOutputs> actions =
      run(net.actor, own) * net.actor_kernel + net.actor_bias;
  const float value = run(net.critic, own).dot(net.critic_kernel) + net.critic_bias;
  return {sigmoid(double{actions[0]}), std::tanh(double{actions[1]}), double{value}};
}

}  // namespace roundabout::planner
