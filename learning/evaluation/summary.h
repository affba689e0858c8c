#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "learning/evaluation/scores.h"

namespace roundabout::learning {

/// What is called what in tables and figures: "orca", or for weights "ga3c_cadrl (FILE)".
std::string labelOf(const std::string& specification);

/// The table of the paper, as text, with every rule that was used.
std::string summaryText(const Evaluation& evaluation, const std::vector<Score>& scores);

/// The same for programs. Times in s, lengths in m, shares from 0 to 1; null where there is no
/// case.
nlohmann::json summaryJson(const Evaluation& evaluation, const std::vector<Score>& scores);

}  // namespace roundabout::learning
