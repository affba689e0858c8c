// What every clusterer must do, and what is Dynamic Means' own.

#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "perception/clustering/dynamic_means/dynamic_means.h"
#include "perception/clustering/table.h"
#include "perception/detection.h"
#include "tests/perception/crowd.h"
#include "tests/support/startup_error.h"

namespace roundabout::perception {
namespace {

class EveryClusterer : public ::testing::TestWithParam<ClustererEntry> {
 protected:
  std::span<const Cluster> cluster(const core::LaserScan& scan) {
    toPoints(scan, {}, {}, {}, points_);
    findSegments(points_, {}, segments_);
    return clusterer_->cluster(points_, segments_, {});
  }

  std::unique_ptr<Clusterer> clusterer_ = GetParam().make();
  ScanPoints points_;
  std::vector<Segment> segments_;
};
INSTANTIATE_TEST_SUITE_P(Table, EveryClusterer, ::testing::ValuesIn(clustererTable()),
                         [](const auto& entry) { return std::string(entry.param.name); });

TEST_P(EveryClusterer, PutsEverySegmentIntoOneCluster) {
  test::Crowd crowd({.people = 10, .noise_m = 0.03, .missed_share = 0.05});
  for (int i = 0; i < 200; ++i) {
    crowd.step(0.025);
    std::vector<std::size_t> members;
    for (const Cluster& cluster : cluster(crowd.scan())) {
      EXPECT_FALSE(cluster.empty());
      members.insert(members.end(), cluster.begin(), cluster.end());
    }
    std::sort(members.begin(), members.end());
    std::vector<std::size_t> all(segments_.size());
    std::iota(all.begin(), all.end(), 0U);
    ASSERT_EQ(members, all);
  }
}

TEST_P(EveryClusterer, SaysTheSameAgain) {
  test::Crowd crowd({.people = 8});
  const std::unique_ptr<Clusterer> twin = GetParam().make();
  for (int i = 0; i < 100; ++i) {
    crowd.step(0.025);
    const auto clusters = cluster(crowd.scan());
    const auto others = twin->cluster(points_, segments_, {});
    ASSERT_TRUE(std::equal(clusters.begin(), clusters.end(), others.begin(), others.end()));
  }
}

TEST_P(EveryClusterer, TakesTwoLegsForOnePersonAndTwoPeopleForTwo) {
  for (const double apart_m : {1.0, 1.5, 3.0}) {
    clusterer_ = GetParam().make();
    config::Lidar settings;
    settings.beams = 1080;
    settings.max_range_m = 10.0;
    sim::Lidar lidar(settings);
    std::vector<sim::Disc> legs;
    for (const double side_m : {-apart_m / 2.0, apart_m / 2.0}) {
      legs.push_back({{2.5, side_m - 0.12}, 0.06});
      legs.push_back({{2.5, side_m + 0.12}, 0.06});
    }
    const auto seen = lidar.sweep({0.0, 0.0}, 0.0, {legs, {}, nullptr});
    const auto clusters = cluster({1'000'000,
                                   seen.first_angle_rad,
                                   seen.angle_step_rad,
                                   {seen.ranges_m.begin(), seen.ranges_m.end()}});
    ASSERT_EQ(clusters.size(), 2U) << apart_m;
    EXPECT_EQ(clusters[0].size(), 2U);
    EXPECT_EQ(clusters[1].size(), 2U);
  }
}

TEST_P(EveryClusterer, TakesAnEmptyScan) {
  EXPECT_TRUE(cluster({0, -1.0, 0.01, std::vector<float>(200, 20.0F)}).empty());
}

/// What a lidar at the origin says of a person with legs in these places.
Detection personOn(const std::vector<Eigen::Vector2d>& legs_m) {
  config::Lidar settings;
  settings.beams = 1080;
  settings.max_range_m = 10.0;
  std::vector<sim::Disc> legs;
  for (const Eigen::Vector2d& leg_m : legs_m) {
    legs.push_back({leg_m, 0.06});
  }
  sim::Lidar lidar(settings);
  const auto seen = lidar.sweep({0.0, 0.0}, 0.0, {legs, {}, nullptr});
  ScanPoints points;
  toPoints({1'000'000,
            seen.first_angle_rad,
            seen.angle_step_rad,
            {seen.ranges_m.begin(), seen.ranges_m.end()}},
           {}, {}, {}, points);
  std::vector<Segment> segments;
  findSegments(points, {}, segments);
  const auto clusterer = makeClusterer("breakpoints", "test");
  const auto clusters = clusterer->cluster(points, segments, {});
  EXPECT_EQ(clusters.size(), 1U);
  return detectionOf(points, segments, clusters[0]);
}

TEST(Detection, OfTwoLegsIsBetweenThem) {
  for (const double half_m : {0.07, 0.1, 0.2}) {  // as one segment, and as two
    const Detection person = personOn({{3.0, half_m}, {3.0, -half_m}});
    EXPECT_EQ(person.legs, 2) << half_m;
    EXPECT_LT((person.position_m - Eigen::Vector2d(3.0, 0.0)).norm(), 0.02) << half_m;
  }
}

TEST(Detection, OfALegBeforeTheOtherIsFartherThanWhatIsSeenAndLessSureOfItsDepth) {
  const Detection person = personOn({{3.0, 0.0}, {3.2, 0.0}});
  EXPECT_EQ(person.legs, 1);
  EXPECT_LT((person.position_m - Eigen::Vector2d(3.1, 0.0)).norm(), 0.03);
  EXPECT_GT(person.covariance_m2(0, 0), 1.5 * person.covariance_m2(1, 1));
  EXPECT_NEAR(person.covariance_m2(0, 1), 0.0, 1e-4);
  // The same on a bearing of 45 degrees.
  const Detection turned = personOn({{2.1, 2.1}, {2.25, 2.25}});
  EXPECT_NEAR(turned.covariance_m2(0, 0), turned.covariance_m2(1, 1), 1e-3);
  EXPECT_GT(turned.covariance_m2(0, 1), 0.2 * turned.covariance_m2(0, 0));
}

TEST(ClustererTable, NamesWhatThereIs) {
  EXPECT_EQ(test::startupErrorOf([] { makeClusterer("k_means", "lab.yaml"); }),
            "lab.yaml: perception.clusterer: expected one of breakpoints, dynamic_means, found "
            "\"k_means\"");
}

// Points around centres that move, as in the paper's first experiment.
class MovingGaussians {
 public:
  explicit MovingGaussians(std::uint64_t seed) : random_(seed, "gaussians") {
    for (int i = 0; i < 5; ++i) {
      centres_m_.emplace_back(2.0 * i, random_.uniform(-1.0, 1.0));
    }
  }
  std::vector<Eigen::Vector2d> step() {
    std::vector<Eigen::Vector2d> points;
    truth_.clear();
    for (std::size_t k = 0; k < centres_m_.size(); ++k) {
      centres_m_[k] += Eigen::Vector2d(random_.normal(0.03), random_.normal(0.03));
      for (int i = 0; i < 15; ++i) {
        points.emplace_back(centres_m_[k] +
                            Eigen::Vector2d(random_.normal(0.05), random_.normal(0.05)));
        truth_.push_back(k);
      }
    }
    return points;
  }
  const std::vector<std::size_t>& truth() const { return truth_; }

 private:
  core::RandomStream random_;
  std::vector<Eigen::Vector2d> centres_m_;
  std::vector<std::size_t> truth_;
};

TEST(DynamicMeans, NeverRaisesItsObjective) {
  core::RandomStream random(3, "points");
  DynamicMeans means({.lambda_m2 = 0.1});
  for (int step = 0; step < 50; ++step) {
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 60; ++i) {
      points.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1));
    }
    const DynamicMeans::Result& result = means.step(points);
    for (std::size_t i = 1; i < result.costs.size(); ++i) {
      EXPECT_LE(result.costs[i], result.costs[i - 1] + 1e-12);
    }
  }
}

TEST(DynamicMeans, KeepsTheLabelsOfClustersThatMove) {
  MovingGaussians gaussians(1);
  DynamicMeans means({.lambda_m2 = 0.3});
  std::vector<std::int64_t> label_of(5, -1);
  for (int step = 0; step < 100; ++step) {
    const auto points = gaussians.step();
    const auto& labels = means.step(points).labels;
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::int64_t& label = label_of[gaussians.truth()[i]];
      label = label < 0 ? labels[i] : label;
      ASSERT_EQ(labels[i], label) << "step " << step;
    }
  }
  EXPECT_EQ(std::set<std::int64_t>(label_of.begin(), label_of.end()).size(), 5U);
}

TEST(DynamicMeans, RemembersWhoWasHiddenUntilTheirTimeIsUp) {
  const std::vector<Eigen::Vector2d> here{{1.0, 1.0}, {1.05, 1.0}};
  for (const auto& [steps_hidden, same] : {std::pair{4, true}, std::pair{20, false}}) {
    DynamicMeans means({.lambda_m2 = 0.1, .survival_steps = 10.0});
    const std::int64_t before = means.step(here).labels[0];
    for (int i = 0; i < steps_hidden; ++i) {
      means.step({});
    }
    EXPECT_EQ(means.step(here).labels[0] == before, same) << steps_hidden;
  }
}

TEST(DynamicMeans, IsDpMeansOnTheFirstBatch) {
  // One point at lambda's distance begins a cluster of its own; one nearer does not.
  DynamicMeans means({.lambda_m2 = 0.25});
  const std::vector<Eigen::Vector2d> points{{0.0, 0.0}, {0.49, 0.0}, {2.0, 0.0}};
  const DynamicMeans::Result& result = means.step(points);
  EXPECT_EQ(result.labels[0], result.labels[1]);
  EXPECT_NE(result.labels[0], result.labels[2]);
  EXPECT_NEAR(result.cost, 2 * 0.25 + 2 * 0.245 * 0.245, 1e-12);
}

}  // namespace
}  // namespace roundabout::perception
