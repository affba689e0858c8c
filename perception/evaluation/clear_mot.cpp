#include "perception/evaluation/clear_mot.h"

#include <algorithm>
#include <cmath>

#include "common/core/assignment.h"

namespace roundabout::perception {

void ClearMot::add(std::span<const Sighting> truth, std::span<const Sighting> tracked) {
  sums_.truths += static_cast<std::int64_t>(truth.size());
  std::vector<bool> truth_left(truth.size(), true);
  std::vector<bool> track_left(tracked.size(), true);
  const auto match = [&](std::size_t i, std::size_t j) {
    truth_left[i] = track_left[j] = false;
    ++matches_;
    sums_.precision_m += (truth[i].position_m - tracked[j].position_m).norm();
    sums_.velocity_rms_mps += (truth[i].velocity_mps - tracked[j].velocity_mps).squaredNorm();
    const auto known = track_of_.find(truth[i].id);
    sums_.switches += known != track_of_.end() && known->second != tracked[j].id ? 1 : 0;
    track_of_[truth[i].id] = tracked[j].id;
  };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto known = track_of_.find(truth[i].id);
    for (std::size_t j = 0; j < tracked.size() && known != track_of_.end() && truth_left[i]; ++j) {
      if (track_left[j] && tracked[j].id == known->second &&
          (truth[i].position_m - tracked[j].position_m).norm() < reach_m_) {
        match(i, j);
      }
    }
  }
  std::vector<std::size_t> people;
  std::vector<std::size_t> tracks;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth_left[i]) {
      people.push_back(i);
    }
  }
  for (std::size_t j = 0; j < tracked.size(); ++j) {
    if (track_left[j]) {
      tracks.push_back(j);
    }
  }
  // One column more a person: missed, which costs as much as the farthest match.
  const auto rows = static_cast<Eigen::Index>(people.size());
  const auto columns = static_cast<Eigen::Index>(tracks.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, columns + rows, reach_m_);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      const double distance_m = (truth[people[static_cast<std::size_t>(i)]].position_m -
                                 tracked[tracks[static_cast<std::size_t>(j)]].position_m)
                                    .norm();
      cost(i, j) = distance_m < reach_m_ ? distance_m : 1e6;
    }
  }
  if (rows > 0 && columns > 0) {
    const core::Assignment person_of = core::assignAtLeastCost(cost);
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      if (person_of[j] != core::kUnassigned) {
        match(people[person_of[j]], tracks[j]);
      }
    }
  }
  sums_.misses += std::count(truth_left.begin(), truth_left.end(), true);
  sums_.false_tracks += std::count(track_left.begin(), track_left.end(), true);
}

ClearMot::Result ClearMot::result() const {
  Result result = sums_;
  const auto matches = static_cast<double>(std::max<std::int64_t>(matches_, 1));
  result.accuracy =
      1.0 - static_cast<double>(result.misses + result.false_tracks + result.switches) /
                static_cast<double>(std::max<std::int64_t>(result.truths, 1));
  result.precision_m /= matches;
  result.velocity_rms_mps = std::sqrt(result.velocity_rms_mps / matches);
  return result;
}

}  // namespace roundabout::perception
