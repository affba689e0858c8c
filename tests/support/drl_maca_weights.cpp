#include "tests/support/drl_maca_weights.h"

#include <algorithm>
#include <vector>

#include "planner/policies/drl_maca/weights.h"
#include "tests/support/random_tensors.h"

namespace roundabout::test {

planner::nn::TensorFile randomDrlMaca(std::uint64_t seed) {
  planner::nn::TensorFile file = randomTensors(planner::kDrlMacaTensors, seed);
  file.metadata = planner::drlMacaMetadata("random, for tests");
  return file;
}

planner::nn::TensorFile goalSeekingDrlMaca() {
  planner::nn::TensorFile file = randomDrlMaca();
  for (auto& [name, tensor] : file.tensors) {
    std::fill(tensor.values.begin(), tensor.values.end(), 0.0F);
  }
  // Two units of the last layer: how far to the left the goal is, and how far to the right.
  constexpr std::size_t kGoalLeft = planner::DrlMacaTrunk::kWide + 1;
  std::vector<float>& joint = file.tensors["actor/dense2/kernel"].values;
  joint[kGoalLeft * planner::DrlMacaTrunk::kNarrow] = 1.0F;
  joint[kGoalLeft * planner::DrlMacaTrunk::kNarrow + 1] = -1.0F;
  file.tensors["actor/angular/kernel"].values[0] = 1.0F;
  file.tensors["actor/angular/kernel"].values[1] = -1.0F;
  file.tensors["actor/linear/bias"].values[0] = 1.0F;
  file.metadata = planner::drlMacaMetadata("seeks its goal, for tests");
  return file;
}

}  // namespace roundabout::test
