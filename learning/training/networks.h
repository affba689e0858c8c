#pragma once

#include <memory>
#include <string>

#include "common/core/random.h"
#include "learning/training/recipe.h"
#include "learning/training/trainable_network.h"
#include "planner/others_order.h"

namespace roundabout::learning {

/// What a recipe says of the network, in the words of weight files.
struct NetworkPlan {
  std::string architecture;
  int max_others = 0;
  planner::OthersOrder others_order = planner::OthersOrder::kClosestLast;
  planner::ValueBaseline value_baseline = planner::ValueBaseline::kLoneAgent;
  bool by_torch = false;  ///< also where there is one written by hand

  ParameterLayout layout() const;
};

NetworkPlan networkPlan(const Recipe& recipe);

/// The heads begin near zero, so that at first all actions are as likely.
Parameters initialParameters(const ParameterLayout& layout, core::RandomStream& random);

/// One written by hand if there is one; otherwise libtorch's. Throws as makeTorchNetwork() does.
std::unique_ptr<TrainableNetwork> makeNetwork(const NetworkPlan& plan);

}  // namespace roundabout::learning
