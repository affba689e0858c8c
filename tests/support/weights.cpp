#include "tests/support/weights.h"

#include "tests/support/random_tensors.h"

namespace roundabout::test {

planner::Normalisation unusualNormalisation() {
  return {.ego_mean = {1.0, 0.1, 0.9, 0.4},
          .ego_deviation = {4.0, 3.0, 0.8, 0.5},
          .other_mean = {0.1, -0.2, 0.3, -0.4, 0.5, 0.6, 0.7},
          .other_deviation = {4.0, 3.0, 2.0, 1.5, 0.5, 1.0, 6.0}};
}

planner::nn::TensorFile randomGa3cCadrl(std::uint64_t seed, std::string_view architecture,
                                        int max_others) {
  planner::nn::TensorFile file =
      randomTensors(planner::ga3cCadrlTensors(architecture, max_others), seed);
  file.metadata = planner::ga3cCadrlMetadata({.architecture = architecture,
                                              .normalisation = unusualNormalisation(),
                                              .max_others = max_others,
                                              .others_order = planner::OthersOrder::kClosestLast,
                                              .provenance = "random, for tests"});
  return file;
}

void writeRandomGa3cCadrl(const std::string& path, std::uint64_t seed) {
  planner::nn::writeSafetensors(path, randomGa3cCadrl(seed));
}

}  // namespace roundabout::test
