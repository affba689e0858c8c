#include "learning/training/weight_files.h"

#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::learning {

namespace {

constexpr int kMaxOthers = 19;  // as the published networks

}  // namespace

planner::nn::TensorFile weightFile(const ParameterLayout& layout, const Parameters& parameters,
                                   const std::string& provenance) {
  planner::nn::TensorFile file;
  layout.write(parameters, "", file);
  file.metadata = planner::ga3cCadrlMetadata({.architecture = planner::kPooledArchitecture,
                                              .normalisation = planner::kPublishedNormalisation,
                                              .max_others = kMaxOthers,
                                              .others_order = planner::OthersOrder::kClosestLast,
                                              .value_baseline = planner::ValueBaseline::kLoneAgent,
                                              .stall = planner::StallSettings{},
                                              .provenance = provenance});
  return file;
}

}  // namespace roundabout::learning
