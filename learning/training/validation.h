#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "learning/evaluation/scores.h"
#include "learning/training/recipe.h"
#include "planner/nn/safetensors.h"

namespace roundabout::learning {

/// How a network does on the fixed cases of a recipe, as `roundabout evaluate` judges it.
struct ValidationFigures {
  std::vector<Score> scores;  ///< one for each number of agents
  double cost_s = 0.0;        ///< what is compared: mean over scores of extra time and failures
  double success_share = 0.0;
  double extra_time_s = 0.0;
};

/// The cost of a failure, as extra time.
inline constexpr double kFailureCost_s = 10.0;

/// network: a weight file's contents. Nothing if keep_going() said no before the end.
std::optional<ValidationFigures> validate(const Validation& validation,
                                          const planner::nn::TensorFile& network, int threads,
                                          const std::function<bool()>& keep_going);

}  // namespace roundabout::learning
