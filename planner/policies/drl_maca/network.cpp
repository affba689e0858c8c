#include "planner/policies/drl_maca/network.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace roundabout::planner {

namespace {

using Trunk = DrlMacaTrunk;

constexpr int kPadding = 1;

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// Adds what a place of the second convolution gives to the first dense layer.
void addPlace(const Trunk& trunk, const Trunk::Conv2::Output& features, int place,
              nn::Row<Trunk::kWide>& wide) {
  const Eigen::Map<const nn::Row<Trunk::kChannels>> channels(features.row(place).data());
  nn::addProduct<Trunk::kChannels, Trunk::kWide>(
      channels, trunk.dense1.kernel.middleRows<Trunk::kChannels>(place * Trunk::kChannels), wide);
}

}  // namespace

void DrlMacaTrunk::prepare() {
  Conv1::Input scans = Conv1::makeInput();
  scans.middleRows<kBeams>(kPadding).setConstant(kFreeBeam);
  Conv1::Output features1 = Conv1::makeOutput(kPadding);
  Conv2::Output features2 = Conv2::makeOutput();
  conv1.applyRelu(scans, features1, kPadding);
  conv2.applyRelu(features1, features2);
  free_sums.setZero(kPlaces + 1, kWide);
  for (int place = 0; place < kPlaces; ++place) {
    nn::Row<kWide> added = nn::Row<kWide>::Zero();
    addPlace(*this, features2, place, added);
    free_sums.row(place + 1) = free_sums.row(place) + added.cast<double>();
  }
}

DrlMacaNetwork::DrlMacaNetwork(std::shared_ptr<const DrlMacaWeights> weights)
    : weights_(std::move(weights)),
      scans_(Trunk::Conv1::makeInput()),
      features1_(Trunk::Conv1::makeOutput(kPadding)),
      features2_(Trunk::Conv2::makeOutput()) {
  busy_.reserve(Trunk::kPlaces);
}

/// The places that see a beam which hits something, in any of the scans.
void DrlMacaNetwork::findBusyPlaces(const Scans& scans) {
  busy_.clear();
  int beam = 0;
  const auto nextHit = [&](int from) {
    beam = from;
    while (beam < Trunk::kBeams && std::all_of(scans.begin(), scans.end(), [&](const auto& scan) {
             return scan[static_cast<std::size_t>(beam)] == Trunk::kFreeBeam;
           })) {
      ++beam;
    }
    return beam < Trunk::kBeams;
  };
  while (nextHit(beam)) {
    // Place p sees beams 4p - 3 to 4p + 5: through the places 2p - 1 to 2p + 1 of the first
    // convolution, of which place q sees beams 2q - 1 to 2q + 3.
    const int begin = std::max((beam - 2) / 4, 0);
    const int end = std::min((beam + 3) / 4 + 1, Trunk::kPlaces);
    if (!busy_.empty() && begin <= busy_.back().end) {
      busy_.back().end = end;
    } else {
      busy_.push_back({begin, end});
    }
    ++beam;
  }
}

const nn::Row<DrlMacaTrunk::kNarrow>& DrlMacaNetwork::run(const Trunk& trunk,
                                                          const OwnInputs& own) {
  Eigen::Matrix<double, 1, Trunk::kWide> free_sum = trunk.free_sums.row(Trunk::kPlaces);
  for (const Places& places : busy_) {
    free_sum -= trunk.free_sums.row(places.end) - trunk.free_sums.row(places.begin);
  }
  wide_ = trunk.dense1.bias + free_sum.cast<float>();
  for (const Places& places : busy_) {
    trunk.conv1.applyRelu(scans_, features1_, kPadding, std::max(2 * places.begin - 1, 0),
                          std::min(2 * places.end, Trunk::Conv1::kOutputLength));
    trunk.conv2.applyRelu(features1_, features2_, 0, places.begin, places.end);
    for (int place = places.begin; place < places.end; ++place) {
      addPlace(trunk, features2_, place, wide_);
    }
  }
  joint_ << wide_.cwiseMax(0.0F), Eigen::Map<const nn::Row<Trunk::kOwnInputs>>(own.data());
  trunk.dense2.applyRelu(joint_, narrow_);
  return narrow_;
}

DrlMacaNetwork::Output DrlMacaNetwork::evaluate(const Scans& scans, const OwnInputs& own,
                                                bool with_value) {
  for (int scan = 0; scan < Trunk::kScans; ++scan) {
    scans_.col(scan).segment<Trunk::kBeams>(kPadding) =
        Eigen::Map<const Eigen::Matrix<float, Trunk::kBeams, 1>>(
            scans[static_cast<std::size_t>(scan)].data());
  }
  findBusyPlaces(scans);
  const DrlMacaWeights& net = *weights_;
  const nn::Row<DrlMacaWeights::kActorOutputs> actions =
      run(net.actor, own) * net.actor_kernel + net.actor_bias;
  Output output{sigmoid(double{actions[0]}), std::tanh(double{actions[1]})};
  if (with_value) {
    output.value = double{run(net.critic, own).dot(net.critic_kernel) + net.critic_bias};
  }
  return output;
}

}  // namespace roundabout::planner
