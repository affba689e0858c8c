#include "sim/sensors/lidar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/allocation_count.h"

namespace roundabout::sim {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

struct Place {
  Vector2d position_m;
  double heading_rad;
};

struct Scene {
  std::vector<Disc> discs;
  std::vector<core::Polygon> polygons;
  AlignedBox2d walls{Vector2d(-8.0, -6.0), Vector2d(7.0, 9.0)};

  Surfaces surfaces() const { return {discs, polygons, &walls}; }
};

Vector2d anywhere(core::RandomStream& random, double bound_m) {
  const double x = random.uniform(-bound_m, bound_m);
  const double y = random.uniform(-bound_m, bound_m);
  return {x, y};
}

Scene randomScene(core::RandomStream& random) {
  Scene scene;
  for (int i = 0; i < 6; ++i) {
    scene.discs.push_back({anywhere(random, 5.0), random.uniform(0.1, 1.0)});
  }
  for (int i = 0; i < 3; ++i) {
    const Vector2d centre = anywhere(random, 5.0);
    core::Polygon polygon;
    for (int corner = 0; corner < 3 + i; ++corner) {
      const double angle_rad = 2.0 * std::numbers::pi * corner / (3 + i);
      polygon.push_back(centre + random.uniform(0.3, 1.0) *
                                     Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    scene.polygons.push_back(polygon);
  }
  return scene;
}

bool inDisc(const Scene& scene, const Vector2d& place_m) {
  return std::any_of(scene.discs.begin(), scene.discs.end(), [&](const Disc& disc) {
    return (place_m - disc.centre_m).norm() <= disc.radius_m;
  });
}

// By the crossing of its sides to the right of the place.
bool inPolygon(const core::Polygon& polygon, const Vector2d& place_m) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const bool spans = (a.y() > place_m.y()) != (b.y() > place_m.y());
    if (spans && place_m.x() < a.x() + (place_m.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
      inside = !inside;
    }
  }
  return inside;
}

// On which side of every surface a place lies: a beam that walks to another one has hit.
std::vector<bool> sides(const Scene& scene, const Vector2d& place_m) {
  std::vector<bool> result = {inDisc(scene, place_m), scene.walls.contains(place_m)};
  for (const core::Polygon& polygon : scene.polygons) {
    result.push_back(inPolygon(polygon, place_m));
  }
  return result;
}

// Walks along the beam until a side changes, then halves the last step.
double walkedRange(const Scene& scene, const Vector2d& from_m, double angle_rad, double max_m) {
  constexpr double kStepM = 0.002;
  const Vector2d beam(std::cos(angle_rad), std::sin(angle_rad));
  const std::vector<bool> begin = sides(scene, from_m);
  if (begin[0]) {
    return 0.0;
  }
  for (double walked_m = 0.0; walked_m < max_m; walked_m += kStepM) {
    if (sides(scene, from_m + (walked_m + kStepM) * beam) == begin) {
      continue;
    }
    double low = walked_m;
    double high = walked_m + kStepM;
    for (int i = 0; i < 40; ++i) {
      const double middle = (low + high) / 2.0;
      (sides(scene, from_m + middle * beam) == begin ? low : high) = middle;
    }
    return std::min(low, max_m);
  }
  return max_m;
}

TEST(Lidar, SeesWhatAWalkAlongEachBeamMeets) {
  core::RandomStream random(1, "lidar");
  config::Lidar settings;
  settings.beams = 37;
  int grazed = 0;
  int beams = 0;
  for (int i = 0; i < 40; ++i) {
    const Scene scene = randomScene(random);
    settings.field_of_view_rad = random.uniform(0.5, 2.0 * std::numbers::pi);
    settings.max_range_m = random.uniform(1.0, 10.0);
    Lidar lidar(settings);
    const Place place = {anywhere(random, 6.0),
                         random.uniform(-std::numbers::pi, std::numbers::pi)};
    const core::RangeScan scan = lidar.sweep(place.position_m, place.heading_rad, scene.surfaces());
    ASSERT_EQ(scan.ranges_m.size(), 37U);
    EXPECT_DOUBLE_EQ(scan.first_angle_rad, -settings.field_of_view_rad / 2.0);
    EXPECT_NEAR(scan.first_angle_rad + 36 * scan.angle_step_rad, settings.field_of_view_rad / 2.0,
                1e-12);
    for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
      const double angle_rad =
          place.heading_rad + scan.first_angle_rad + static_cast<double>(k) * scan.angle_step_rad;
      const double walked_m = walkedRange(scene, place.position_m, angle_rad, settings.max_range_m);
      ++beams;
      // The walk steps over what a beam only grazes; it never meets what is not there.
      EXPECT_LE(scan.ranges_m[k], walked_m + 1e-5) << "scene " << i << " beam " << k;
      grazed += scan.ranges_m[k] < walked_m - 1e-5 ? 1 : 0;
    }
  }
  EXPECT_LT(grazed, beams / 200);
}

TEST(Lidar, FirstBeamLooksRightLastOneLeft) {
  Lidar lidar(config::Lidar{.beams = 3});
  const std::vector<Disc> discs = {{{0.0, -2.0}, 0.5}, {{3.0, 0.0}, 1.0}};
  const core::RangeScan scan = lidar.sweep({0.0, 0.0}, 0.0, {discs});
  EXPECT_FLOAT_EQ(scan.ranges_m[0], 1.5F);
  EXPECT_FLOAT_EQ(scan.ranges_m[1], 2.0F);
  EXPECT_FLOAT_EQ(scan.ranges_m[2], 6.0F);
  const core::RangeScan turned = lidar.sweep({0.0, 0.0}, std::numbers::pi / 2.0, {discs});
  EXPECT_FLOAT_EQ(turned.ranges_m[0], 2.0F);
}

TEST(Lidar, NoBeamLeavesAClosedRoomThroughItsCorners) {
  config::Lidar settings{.beams = 721, .field_of_view_rad = 2.0 * std::numbers::pi};
  settings.max_range_m = 100.0;
  Lidar lidar(settings);
  const AlignedBox2d room(Vector2d(-3.0, -3.0), Vector2d(3.0, 3.0));
  core::RandomStream random(2, "rooms");
  for (int i = 0; i < 200; ++i) {
    // On a grid, so that beams meet corners exactly.
    const Vector2d place(std::round(random.uniform(-2.4, 2.4)),
                         std::round(random.uniform(-2.4, 2.4)));
    const double heading_rad = std::numbers::pi / 4.0 * std::round(random.uniform(-4.0, 4.0));
    const core::RangeScan scan = lidar.sweep(place, heading_rad, {{}, {}, &room});
    EXPECT_LT(*std::max_element(scan.ranges_m.begin(), scan.ranges_m.end()), 9.0F);
  }
}

TEST(Lidar, NoiseIsRepeatableAndTouchesOnlyWhatIsHit) {
  config::Lidar settings;
  settings.noise_m = 0.05;
  Lidar lidar(settings);
  const std::vector<Disc> discs = {{{3.0, 0.0}, 0.5}, {{0.55, 2.0}, 0.5}};
  const auto sweep = [&](std::uint64_t seed, bool noisy) {
    core::RandomStream noise(seed, "lidar");
    const core::RangeScan scan = lidar.sweep({0.0, 0.0}, 0.3, {discs}, noisy ? &noise : nullptr);
    return std::vector<float>(scan.ranges_m.begin(), scan.ranges_m.end());
  };
  const std::vector<float> exact = sweep(1, false);
  const std::vector<float> noisy = sweep(1, true);
  EXPECT_EQ(noisy, sweep(1, true));
  EXPECT_NE(noisy, sweep(2, true));
  double sum_of_squares = 0.0;
  int hits = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (exact[i] == 6.0F) {
      EXPECT_EQ(noisy[i], 6.0F);
      continue;
    }
    EXPECT_GE(noisy[i], 0.0F);
    sum_of_squares += std::pow(noisy[i] - exact[i], 2);
    ++hits;
  }
  ASSERT_GT(hits, 50);
  EXPECT_NEAR(std::sqrt(sum_of_squares / hits), 0.05, 0.01);
}

TEST(Lidar, MissesTheShareThatItIsToldTo) {
  config::Lidar settings;
  settings.beams = 1001;
  settings.missed_share = 0.2;
  Lidar lidar(settings);
  const Eigen::AlignedBox2d room(Vector2d(-3.0, -3.0), Vector2d(3.0, 3.0));
  core::RandomStream noise(1, "lidar");
  int missed = 0;
  constexpr int kSweeps = 50;
  for (int i = 0; i < kSweeps; ++i) {
    const core::RangeScan scan = lidar.sweep({0.0, 0.0}, 0.0, {{}, {}, &room}, &noise);
    missed += static_cast<int>(std::count(scan.ranges_m.begin(), scan.ranges_m.end(), 6.0F));
  }
  EXPECT_NEAR(missed / (kSweeps * 1001.0), 0.2, 0.01);
}

TEST(Lidar, MixesPixelsAtEdgesOnlyAndBetweenTheirTwoSides) {
  config::Lidar settings;
  settings.mixed_share = 1.0;
  Lidar lidar(settings);
  const std::vector<Disc> discs = {{{1.5, 0.0}, 0.2}};
  const Eigen::AlignedBox2d room(Vector2d(-3.0, -3.0), Vector2d(3.0, 3.0));
  const Surfaces surfaces{discs, {}, &room};
  const auto exact_scan = lidar.sweep({0.0, 0.0}, 0.0, surfaces);
  const std::vector<float> exact(exact_scan.ranges_m.begin(), exact_scan.ranges_m.end());
  core::RandomStream noise(1, "lidar");
  const auto mixed = lidar.sweep({0.0, 0.0}, 0.0, surfaces, &noise).ranges_m;
  int changed = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (mixed[i] != exact[i]) {
      ++changed;
      EXPECT_GT(mixed[i], 1.3F - 1e-3F);
      EXPECT_LT(mixed[i], 3.0F * 1.4143F);
    }
  }
  EXPECT_EQ(changed, 2) << "the two edges of the disc";
}

// What a beam saw, put back to where it left from, is on the surface: an oracle for the motion.
TEST(Lidar, BeamsOfASweepLeaveFromWhereTheSensorWasAtTheirTime) {
  config::Lidar settings;
  settings.beams = 361;
  settings.sweep_s = 0.1;
  settings.max_range_m = 30.0;
  Lidar lidar(settings);
  const Eigen::AlignedBox2d room(Vector2d(-4.0, -5.0), Vector2d(6.0, 3.0));
  const SensorMotion motion{{1.5, -0.5}, 2.0};
  const Vector2d end(0.5, 0.25);
  constexpr double kHeading = 0.4;
  const core::RangeScan scan = lidar.sweep(end, kHeading, {{}, {}, &room}, nullptr, motion);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double before_s = settings.sweep_s * (1.0 - static_cast<double>(i) / 360.0);
    const Vector2d from = end - before_s * motion.velocity_mps;
    const double angle_rad = kHeading - before_s * motion.turn_rate_radps + scan.first_angle_rad +
                             static_cast<double>(i) * scan.angle_step_rad;
    const Vector2d hit =
        from + double{scan.ranges_m[i]} * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    EXPECT_NEAR(room.exteriorDistance(hit), 0.0, 1e-5);
    const double inside_m = std::min((hit - room.min()).minCoeff(), (room.max() - hit).minCoeff());
    EXPECT_NEAR(inside_m, 0.0, 1e-5) << i;
  }
}

TEST(Lidar, AllocatesNothingAfterItIsMade) {
  core::RandomStream random(3, "lidar");
  const Scene scene = randomScene(random);
  config::Lidar settings;
  settings.noise_m = 0.01;
  settings.missed_share = 0.01;
  settings.mixed_share = 0.5;
  settings.sweep_s = 0.02;
  Lidar lidar(settings);
  const std::size_t before = test::allocationCount();
  lidar.sweep({0.1, 0.2}, 0.3, scene.surfaces(), &random);
  EXPECT_EQ(test::allocationCount(), before);
}

}  // namespace
}  // namespace roundabout::sim
