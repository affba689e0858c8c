#include "perception/clustering/dynamic_means/dynamic_means.h"

#include <algorithm>
#include <limits>
#include <map>

#include "perception/detection.h"

namespace roundabout::perception {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

}  // namespace

double DynamicMeans::ageCost(const Known& cluster) const {
  // A new one costs lambda, an old one Q delta t: nothing if it had points in the last step's turn.
  return cluster.weight == 0.0 ? settings_.lambda_m2
                               : settings_.lambda_m2 / settings_.survival_steps * cluster.steps;
}

const DynamicMeans::Result& DynamicMeans::step(std::span<const Eigen::Vector2d> points_m) {
  for (Known& cluster : clusters_) {
    cluster.gamma = 1.0 / (1.0 / cluster.weight + cluster.steps * settings_.tau);
    cluster.old_m = cluster.centre_m;
    cluster.active = false;
    cluster.count = 0;
  }
  cluster_of_.assign(points_m.size(), kNone);
  result_.costs.clear();
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < settings_.most_iterations; ++i) {
    assign(points_m);
    moveCentres(points_m);
    const double now = objective(points_m);
    result_.costs.push_back(now);
    if (now >= before) {
      break;
    }
    before = now;
  }
  result_.cost = result_.costs.empty() ? 0.0 : result_.costs.back();
  result_.labels.clear();
  for (const std::size_t cluster : cluster_of_) {
    result_.labels.push_back(clusters_[cluster].label);
  }
  finish();
  return result_;
}

void DynamicMeans::forget() { clusters_.clear(); }

void DynamicMeans::assign(std::span<const Eigen::Vector2d> points_m) {
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (cluster_of_[i] != kNone) {
      Known& own = clusters_[cluster_of_[i]];
      own.active = --own.count > 0;
    }
    double least = settings_.lambda_m2;
    std::size_t best = kNone;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
      const Known& cluster = clusters_[k];
      if (!cluster.active && cluster.weight == 0.0) {
        continue;  // a new one that has lost its points
      }
      const double cost = cluster.active
                              ? (points_m[i] - cluster.centre_m).squaredNorm()
                              : ageCost(cluster) + cluster.gamma / (cluster.gamma + 1.0) *
                                                       (points_m[i] - cluster.old_m).squaredNorm();
      if (cost < least) {
        least = cost;
        best = k;
      }
    }
    if (best == kNone) {
      best = clusters_.size();
      clusters_.push_back({next_label_++, points_m[i], 0.0, 0.0});
    }
    Known& cluster = clusters_[best];
    if (!cluster.active) {
      cluster.active = true;
      cluster.centre_m = (cluster.gamma * cluster.old_m + points_m[i]) / (cluster.gamma + 1.0);
    }
    ++cluster.count;
    cluster_of_[i] = best;
  }
}

void DynamicMeans::moveCentres(std::span<const Eigen::Vector2d> points_m) {
  for (Known& cluster : clusters_) {
    if (cluster.active) {
      cluster.centre_m = cluster.gamma * cluster.old_m;
    }
  }
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    clusters_[cluster_of_[i]].centre_m += points_m[i];
  }
  for (Known& cluster : clusters_) {
    if (cluster.active) {
      cluster.centre_m /= cluster.gamma + cluster.count;
    }
  }
}

double DynamicMeans::objective(std::span<const Eigen::Vector2d> points_m) const {
  double cost = 0.0;
  for (const Known& cluster : clusters_) {
    if (cluster.active) {
      cost += ageCost(cluster) + cluster.gamma * (cluster.centre_m - cluster.old_m).squaredNorm();
    }
  }
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    cost += (points_m[i] - clusters_[cluster_of_[i]].centre_m).squaredNorm();
  }
  return cost;
}

void DynamicMeans::finish() {
  for (Known& cluster : clusters_) {
    if (cluster.active) {
      cluster.weight = cluster.gamma + cluster.count;
      cluster.steps = 1.0;
    } else {
      cluster.centre_m = cluster.old_m;
      cluster.steps += 1.0;
    }
  }
  std::erase_if(clusters_, [this](const Known& cluster) {
    return cluster.weight == 0.0 || ageCost(cluster) > settings_.lambda_m2;
  });
}

namespace {

class DynamicMeansClusterer final : public Clusterer {
 public:
  std::span<const Cluster> cluster(const ScanPoints& points, std::span<const Segment> segments,
                                   std::span<const Eigen::Vector2d> /*expected_m*/) override {
    points_m_.clear();
    for (const Segment& segment : segments) {
      for (const std::size_t beam : segment.beams) {
        points_m_.push_back(points.world_m[beam]);
      }
    }
    const std::vector<std::int64_t>& labels = means_.step(points_m_).labels;
    clusters_.clear();
    std::map<std::int64_t, Cluster> members;
    std::size_t point = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      std::map<std::int64_t, int> votes;
      for (std::size_t n = 0; n < segments[i].beams.size(); ++n) {
        ++votes[labels[point++]];
      }
      const auto most =
          std::max_element(votes.begin(), votes.end(),
                           [](const auto& a, const auto& b) { return a.second < b.second; });
      members[most->first].push_back(i);
    }
    centres_m_.clear();
    for (const Segment& segment : segments) {
      centres_m_.push_back(surfaceCentre(points, segment));
    }
    for (auto& [label, cluster] : members) {
      clusters_.push_back(std::move(cluster));
    }
    joinHalves();
    return clusters_;
  }

  void forget() override { means_.forget(); }

 private:
  /// Two clusters that have met never become one again in Dynamic Means: each is the nearest to its
  /// own points. Those whose segments all fit into one cluster are one here.
  void joinHalves() {
    for (std::size_t a = 0; a < clusters_.size(); ++a) {
      for (std::size_t b = clusters_.size() - 1; b > a; --b) {
        Cluster both = clusters_[a];
        both.insert(both.end(), clusters_[b].begin(), clusters_[b].end());
        if (both.size() == 2 && fitsIntoOne(both)) {
          clusters_[a] = std::move(both);
          clusters_.erase(clusters_.begin() + static_cast<std::ptrdiff_t>(b));
          break;
        }
      }
    }
  }

  bool fitsIntoOne(const Cluster& cluster) const {
    Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
    for (const std::size_t segment : cluster) {
      sum_m += centres_m_[segment];
    }
    const Eigen::Vector2d middle_m = sum_m / static_cast<double>(cluster.size());
    return std::all_of(cluster.begin(), cluster.end(), [&](std::size_t segment) {
      return (centres_m_[segment] - middle_m).squaredNorm() < settings_.lambda_m2;
    });
  }

  DynamicMeansSettings settings_;
  DynamicMeans means_{settings_};
  std::vector<Eigen::Vector2d> centres_m_;  // of the segments
  std::vector<Eigen::Vector2d> points_m_;
  std::vector<Cluster> clusters_;
};

}  // namespace

std::unique_ptr<Clusterer> makeDynamicMeans() { return std::make_unique<DynamicMeansClusterer>(); }

}  // namespace roundabout::perception
