#include "learning/training/weight_files.h"

#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::learning {

planner::nn::TensorFile weightFile(const NetworkPlan& plan, const Parameters& parameters,
                                   const std::string& provenance) {
  planner::nn::TensorFile file;
  plan.layout().write(parameters, "", file);
  file.metadata = planner::ga3cCadrlMetadata({.architecture = plan.architecture,
                                              .normalisation = planner::kPublishedNormalisation,
                                              .max_others = plan.max_others,
                                              .others_order = plan.others_order,
                                              .value_baseline = plan.value_baseline,
                                              .stall = planner::StallSettings{},
                                              .provenance = provenance});
  return file;
}

}  // namespace roundabout::learning
