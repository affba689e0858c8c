#pragma once

#include <string>
#include <vector>

namespace roundabout::learning {

/// How the rolling reward of one run grew.
struct LearningCurve {
  std::vector<double> episodes;  ///< ascending
  std::vector<double> reward;
};

/// Of several runs: mean and standard deviation at the same numbers of episodes, as far as the
/// shortest of them goes. Between two reports a run's reward is interpolated.
struct LearningBand {
  std::vector<double> episodes;
  std::vector<double> mean;
  std::vector<double> deviation;
};

/// From a run's folder. Throws core::StartupError if it has no progress to read.
LearningCurve readLearningCurve(const std::string& run);

LearningBand bandOf(const std::vector<LearningCurve>& curves);

/// Runs that are several of one kind: of folders NAME.SEED those of equal NAME, with NAME; all
/// others together, without a name. In the order in which they come.
struct RunGroup {
  std::string name;
  std::vector<std::string> runs;
};
std::vector<RunGroup> groupsOf(const std::vector<std::string>& runs);

/// The paper's training figure: mean and standard deviation over the runs of each group. Writes
/// folder/training.png and .svg; returns the first.
std::string drawTraining(const std::vector<std::string>& runs, const std::string& folder);

}  // namespace roundabout::learning
