#include "tests/support/drl_maca_weights.h"

#include "planner/policies/drl_maca/weights.h"
#include "tests/support/random_tensors.h"

namespace roundabout::test {

planner::nn::TensorFile randomDrlMaca(std::uint64_t seed) {
  planner::nn::TensorFile file = randomTensors(planner::kDrlMacaTensors, seed);
  file.metadata = planner::drlMacaMetadata("random, for tests");
  return file;
}

}  // namespace roundabout::test
