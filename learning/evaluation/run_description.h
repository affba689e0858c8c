#pragma once

#include <nlohmann/json.hpp>

#include "learning/evaluation/evaluation.h"

namespace roundabout::learning {

/// What makes two runs the same: policies and what their weight files hold, cases, rules, mix.
nlohmann::json describeRun(const Evaluation& evaluation);

}  // namespace roundabout::learning
