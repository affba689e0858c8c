#include "learning/evaluation/scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace roundabout::learning {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

ExtraTimes extraTimesOf(std::vector<double> times_s) {
  const double count = static_cast<double>(times_s.size());
  const double sum_s = std::accumulate(times_s.begin(), times_s.end(), 0.0);
  return {times_s.size(), times_s.empty() ? kNaN : sum_s / count, percentile(times_s, 75.0),
          percentile(times_s, 90.0)};
}

/// The rows of one group, for all contestants.
class GroupRows {
 public:
  GroupRows(const Evaluation& evaluation, const std::vector<EpisodeResult>& results,
            std::size_t group)
      : results_(results), per_contestant_(evaluation.casesPerContestant()) {
    for (std::size_t i = 0; i < group; ++i) {
      begin_ += evaluation.suite.groups[i].cases.size();
    }
    solved_by_all_.assign(evaluation.suite.groups[group].cases.size(), true);
    for (std::size_t contestant = 0; contestant < evaluation.contestants.size(); ++contestant) {
      for (std::size_t k = 0; k < size(); ++k) {
        solved_by_all_[k] = solved_by_all_[k] && solved(contestant, k);
      }
    }
  }

  std::size_t size() const { return solved_by_all_.size(); }
  const EpisodeResult& at(std::size_t contestant, std::size_t k) const {
    return results_[contestant * per_contestant_ + begin_ + k];
  }
  bool solved(std::size_t contestant, std::size_t k) const {
    return at(contestant, k).outcome == Outcome::kAllAtGoal;
  }
  bool solvedByAll(std::size_t k) const { return solved_by_all_[k]; }

 private:
  const std::vector<EpisodeResult>& results_;
  std::size_t per_contestant_;
  std::size_t begin_ = 0;
  std::vector<bool> solved_by_all_;
};

Score scoreOf(const GroupRows& rows, std::size_t contestant) {
  Score score;
  long decisions = 0;
  score.cases = rows.size();
  score.closest_separation_m = std::numeric_limits<double>::infinity();
  std::vector<double> own_s;
  std::vector<double> common_s;
  const double share = 1.0 / static_cast<double>(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const EpisodeResult& result = rows.at(contestant, k);
    score.success_share += result.outcome == Outcome::kAllAtGoal ? share : 0.0;
    score.collision_share += result.outcome == Outcome::kCollision ? share : 0.0;
    score.stuck_share += result.outcome == Outcome::kStuck ? share : 0.0;
    score.closest_separation_m = std::min(score.closest_separation_m, result.closest_separation_m);
    score.mean_closest_separation_m += share * result.closest_separation_m;
    if (rows.solved(contestant, k)) {
      own_s.push_back(result.mean_extra_time_s);
    }
    if (rows.solvedByAll(k)) {
      common_s.push_back(result.mean_extra_time_s);
    }
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    decisions += rows.at(contestant, k).decisions;
    for (std::size_t i = 1; i < kShieldLayers; ++i) {
      score.layer_shares[i] += static_cast<double>(rows.at(contestant, k).layers[i]);
    }
  }
  for (double& each : score.layer_shares) {
    each /= static_cast<double>(std::max(decisions, 1L));
  }
  score.own = extraTimesOf(std::move(own_s));
  score.common = extraTimesOf(std::move(common_s));
  return score;
}

}  // namespace

double Score::changedShare() const {
  return std::accumulate(layer_shares.begin(), layer_shares.end(), 0.0);
}

double percentile(std::vector<double> values, double percent) {
  if (values.empty()) {
    return kNaN;
  }
  std::sort(values.begin(), values.end());
  const double rank = percent / 100.0 * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - std::floor(rank)) * (values[above] - values[below]);
}

std::vector<Score> scoresOf(const Evaluation& evaluation,
                            const std::vector<EpisodeResult>& results) {
  std::vector<Score> scores;
  for (std::size_t group = 0; group < evaluation.suite.groups.size(); ++group) {
    const GroupRows rows(evaluation, results, group);
    for (std::size_t contestant = 0; contestant < evaluation.contestants.size(); ++contestant) {
      scores.push_back(scoreOf(rows, contestant));
      scores.back().contestant = contestant;
      scores.back().group = group;
    }
  }
  return scores;
}

}  // namespace roundabout::learning
