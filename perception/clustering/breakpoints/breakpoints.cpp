#include "perception/clustering/breakpoints/breakpoints.h"

#include <algorithm>

#include "common/core/assignment.h"
#include "perception/detection.h"

namespace roundabout::perception {

namespace {

// A leg is nearer to the middle of its person than this.
constexpr double kReach_m = 0.45;
// Legs of one person are not farther apart: a long stride.
constexpr double kLongestStride_m = 0.75;
// Of somebody unknown: two people side by side are farther apart.
constexpr double kUsualStride_m = 0.6;

struct Leg {
  std::size_t segment;
  Eigen::Vector2d centre_m;
};

class Breakpoints final : public Clusterer {
 public:
  std::span<const Cluster> cluster(const ScanPoints& points, std::span<const Segment> segments,
                                   std::span<const Eigen::Vector2d> expected_m) override {
    clusters_.clear();
    legs_.clear();
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (segments[i].width_m <= kWidestLeg_m) {
        legs_.push_back({i, surfaceCentre(points, segments[i])});
      } else {
        clusters_.push_back({i});
      }
    }
    pairAround(expected_m);
    pairNearest();
    for (const Leg& leg : legs_) {
      clusters_.push_back({leg.segment});
    }
    return clusters_;
  }

 private:
  void pairAround(std::span<const Eigen::Vector2d> expected_m) {
    if (legs_.empty() || expected_m.empty()) {
      return;
    }
    // A row a leg; two columns a person, and one a leg for those that are nobody's.
    const auto rows = static_cast<Eigen::Index>(legs_.size());
    const auto people = static_cast<Eigen::Index>(expected_m.size());
    constexpr double kFar = 1e6;
    constexpr double kNobodys = kReach_m * kReach_m;
    Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, 2 * people + rows, kNobodys);
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < people; ++j) {
        const double squared =
            (legs_[static_cast<std::size_t>(i)].centre_m - expected_m[static_cast<std::size_t>(j)])
                .squaredNorm();
        cost(i, 2 * j) = cost(i, 2 * j + 1) = squared < kNobodys ? squared : kFar;
      }
    }
    const core::Assignment leg_of = core::assignAtLeastCost(cost);
    std::vector<bool> used(legs_.size(), false);
    for (std::size_t j = 0; j < expected_m.size(); ++j) {
      const std::size_t a = leg_of[2 * j];
      const std::size_t b = leg_of[2 * j + 1];
      if (a != core::kUnassigned && b != core::kUnassigned &&
          (legs_[a].centre_m - legs_[b].centre_m).norm() <= kLongestStride_m) {
        clusters_.push_back({legs_[a].segment, legs_[b].segment});
        used[a] = used[b] = true;
      } else {
        // A leg near its person is not free to be paired with a neighbour's.
        for (const std::size_t leg : {a, b}) {
          if (leg != core::kUnassigned) {
            clusters_.push_back({legs_[leg].segment});
            used[leg] = true;
          }
        }
      }
    }
    drop(used);
  }

  void pairNearest() {
    std::vector<bool> used(legs_.size(), false);
    while (true) {
      double nearest_m = kUsualStride_m;
      std::size_t a = 0;
      std::size_t b = 0;
      for (std::size_t i = 0; i < legs_.size(); ++i) {
        for (std::size_t j = i + 1; j < legs_.size() && !used[i]; ++j) {
          const double distance_m = (legs_[i].centre_m - legs_[j].centre_m).norm();
          if (!used[j] && distance_m < nearest_m) {
            nearest_m = distance_m;
            a = i;
            b = j;
          }
        }
      }
      if (a == b) {
        break;
      }
      used[a] = used[b] = true;
      clusters_.push_back({legs_[a].segment, legs_[b].segment});
    }
    drop(used);
  }

  void drop(const std::vector<bool>& used) {
    std::size_t index = 0;
    std::erase_if(legs_, [&](const Leg&) { return used[index++]; });
  }

  std::vector<Cluster> clusters_;
  std::vector<Leg> legs_;
};

}  // namespace

std::unique_ptr<Clusterer> makeBreakpoints() { return std::make_unique<Breakpoints>(); }

}  // namespace roundabout::perception
