#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "learning/evaluation/scores.h"

namespace roundabout::learning {

/// What a contestant is called in tables and figures: "orca", or for weights "ga3c_cadrl (FILE)",
/// with the file's whole path where two would be called the same.
std::string labelOf(const Evaluation& evaluation, std::size_t contestant);
/// The same for the others of a mixed crowd.
std::string shortLabel(const std::string& specification);

/// The table of the paper, as text, with every rule that was used.
std::string summaryText(const Evaluation& evaluation, const std::vector<Score>& scores);

/// The same for programs. Times in s, lengths in m, shares from 0 to 1; null where there is no
/// case.
nlohmann::json summaryJson(const Evaluation& evaluation, const std::vector<Score>& scores);

}  // namespace roundabout::learning
