#pragma once

#include <cstdint>
#include <vector>

#include "perception/clustering/clusterer.h"

namespace roundabout::perception {

/// Campbell, Liu, Kulis, How, Carin: Dynamic Clustering via Asymptotics of the Dependent Dirichlet
/// Process Mixture, NIPS 2013. Symbols are the paper's.
struct DynamicMeansSettings {
  double lambda_m2 = 0.10;       ///< squared distance at which a point starts a cluster of its own
  double survival_steps = 40.0;  ///< T_Q: steps without points before a cluster is forgotten
  double tau = 1.0;  ///< how fast the weight of what was seen before goes; Q = lambda / T_Q
  int most_iterations = 30;
};

/// Batches of points in the plane, one a time step; clusters move, appear and disappear.
class DynamicMeans {
 public:
  explicit DynamicMeans(const DynamicMeansSettings& settings) : settings_(settings) {}

  struct Result {
    std::vector<std::int64_t> labels;  ///< of the points; the same cluster in every step
    double cost = 0.0;                 ///< the paper's objective, which no iteration raises
    std::vector<double> costs;         ///< after each iteration
  };

  /// Assigns the points in their order (equations 8 to 10). Valid until the next call.
  const Result& step(std::span<const Eigen::Vector2d> points_m);
  void forget();

 private:
  struct Known {
    std::int64_t label;
    Eigen::Vector2d centre_m;  // phi, then theta once there are points
    double weight;             // w
    double steps;              // delta t since it had points
    double gamma = 0.0;
    bool active = false;
    Eigen::Vector2d old_m = Eigen::Vector2d::Zero();  // phi
    int count = 0;
  };

  void assign(std::span<const Eigen::Vector2d> points_m);
  void moveCentres(std::span<const Eigen::Vector2d> points_m);
  double objective(std::span<const Eigen::Vector2d> points_m) const;
  void finish();
  double ageCost(const Known& cluster) const;

  DynamicMeansSettings settings_;
  std::vector<Known> clusters_;
  std::vector<std::size_t> cluster_of_;  // of the points
  std::int64_t next_label_ = 0;
  Result result_;
};

/// Dynamic Means on the points of the segments; a segment belongs to the cluster of most of its
/// points.
std::unique_ptr<Clusterer> makeDynamicMeans();

}  // namespace roundabout::perception
