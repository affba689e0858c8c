#pragma once

#include <string>
#include <vector>

#include "learning/evaluation/evaluation.h"

namespace roundabout::learning {

/// Of the extra times of some cases, s. NaN if there are none.
struct ExtraTimes {
  std::size_t cases = 0;
  double mean_s;
  double percentile75_s;
  double percentile90_s;
};

/// What one contestant did with one group of cases: a row of the paper's tables.
struct Score {
  std::size_t contestant = 0;
  std::size_t group = 0;
  std::size_t cases = 0;
  double success_share = 0.0;
  double collision_share = 0.0;
  double stuck_share = 0.0;
  ExtraTimes own;                          ///< over the cases that it solved
  ExtraTimes common;                       ///< over those that every contestant solved
  double closest_separation_m = 0.0;       ///< of all cases
  double mean_closest_separation_m = 0.0;  ///< over cases
  /// Of all decisions, those that a layer of the shield changed. kNone: 0.
  std::array<double, kShieldLayers> layer_shares{};

  double changedShare() const;
};

/// Percentile by linear interpolation between order statistics (numpy's default). NaN of nothing.
double percentile(std::vector<double> values, double percent);

/// results: one for each row of the evaluation. Scores by group, then by contestant.
std::vector<Score> scoresOf(const Evaluation& evaluation,
                            const std::vector<EpisodeResult>& results);

}  // namespace roundabout::learning
