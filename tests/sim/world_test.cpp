#include "sim/world.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "common/core/polygon.h"
#include "sim/start_places.h"
#include "tests/support/allocation_count.h"

namespace roundabout::sim {
namespace {

constexpr core::Utime kBegin = core::kMicrosPerSecond;

config::Experiment vehicles(int count) {
  config::Experiment experiment;
  experiment.file = "demo.yaml";
  for (int i = 0; i < count; ++i) {
    experiment.vehicles.emplace_back().name = "hex" + std::to_string(i + 1);
  }
  return experiment;
}

BodyState at(double x, double z = 1.0) {
  BodyState body;
  body.position_world_m = {x, 0.0, z};
  return body;
}

TEST(StartPlaces, LieInTheAreaAndApart) {
  const config::Experiment experiment = vehicles(12);
  const auto starts = startPlaces(experiment);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    EXPECT_TRUE((starts[i].position_m.array() >= experiment.sim.start_area.min_m.array()).all());
    EXPECT_TRUE((starts[i].position_m.array() <= experiment.sim.start_area.max_m.array()).all());
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((starts[i].position_m - starts[j].position_m).norm(),
                experiment.sim.start_spacing_m);
    }
  }
}

TEST(StartPlaces, AreAFunctionOfTheSeed) {
  config::Experiment experiment = vehicles(4);
  const auto first = startPlaces(experiment);
  EXPECT_EQ(first[3].position_m, startPlaces(experiment)[3].position_m);
  experiment.seed = 2;
  EXPECT_NE(first[3].position_m, startPlaces(experiment)[3].position_m);
}

TEST(StartPlaces, TakeAGivenStartAndKeepTheOthersAwayFromIt) {
  config::Experiment experiment = vehicles(8);
  experiment.vehicles[7].start = config::Start{{0.5, -0.5}, 1.0};
  const auto starts = startPlaces(experiment);
  EXPECT_EQ(starts[7].position_m, Eigen::Vector2d(0.5, -0.5));
  EXPECT_EQ(starts[7].heading_rad, 1.0);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_GE((starts[i].position_m - starts[7].position_m).norm(), experiment.sim.start_spacing_m);
  }
}

TEST(StartPlaces, KeepClearOfObstacles) {
  config::Experiment experiment = vehicles(4);
  experiment.obstacles = {{"box", {{-4.0, -4.0}, {2.0, -4.0}, {2.0, 1.0}, {-4.0, 1.0}}}};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    experiment.seed = seed;
    for (const config::Start& start : startPlaces(experiment)) {
      EXPECT_GE(core::distanceTo(experiment.obstacles[0].points_m, start.position_m), 0.6);
    }
  }
}

TEST(StartPlaces, OfALabsFileLieInItsRoom) {
  config::Experiment experiment = vehicles(4);
  experiment.source = "natnet";
  experiment.room = {{-3.0, -3.0, 0.0}, {3.0, 3.0, 3.0}};
  for (const config::Start& start : startPlaces(experiment)) {
    EXPECT_LE(start.position_m.cwiseAbs().maxCoeff(), 3.0 - 0.35);
  }
}

TEST(StartPlaces, AreRefusedWhenTheyDoNotFit) {
  config::Experiment experiment = vehicles(6);
  experiment.sim.start_area = {{0.0, 0.0}, {1.0, 1.0}};
  EXPECT_THAT([&] { startPlaces(experiment); },
              testing::ThrowsMessage<core::StartupError>(
                  testing::StartsWith("demo.yaml: sim.start_area: expected room for 6 vehicles")));
}

TEST(Contacts, CountsOneContactPerTouchAndItsTime) {
  Contacts contacts({0.35, 0.35});
  const double gaps_m[] = {1.0, 0.6, 0.5, 0.71, 0.8, 0.6, 0.9};
  core::Utime now = 0;
  for (const double distance : gaps_m) {
    const BodyState bodies[] = {at(0.0), at(distance)};
    contacts.update(now += 5000, 5000, bodies);
  }
  ASSERT_EQ(contacts.all().size(), 2U);
  EXPECT_EQ(contacts.all()[0].begin, 10'000);
  EXPECT_EQ(contacts.all()[0].duration_us, 10'000);
  EXPECT_EQ(contacts.totalUs(), 15'000);
  EXPECT_NEAR(contacts.closestM(), -0.2, 1e-12);
}

TEST(Contacts, FlyingAboveEachOtherCounts) {
  Contacts contacts({0.35, 0.35});
  const BodyState bodies[] = {at(0.0, 1.0), at(0.1, 3.0)};
  contacts.update(0, 5000, bodies);
  EXPECT_EQ(contacts.all().size(), 1U);
}

TEST(Contacts, KeepsPairsApart) {
  Contacts contacts({0.35, 0.35, 0.35});
  const BodyState bodies[] = {at(0.0), at(0.6), at(1.2)};
  contacts.update(0, 5000, bodies);
  contacts.update(5000, 5000, bodies);
  ASSERT_EQ(contacts.all().size(), 2U);
  EXPECT_EQ(contacts.all()[1].first, 1U);
  EXPECT_EQ(contacts.all()[1].second, 2U);
}

TEST(Contacts, WithObstaclesCountToo) {
  const core::Polygon box = {{1.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}, {1.0, 1.0}};
  const core::Polygon far_box = {{9.0, -1.0}, {9.5, -1.0}, {9.5, 1.0}, {9.0, 1.0}};
  Contacts contacts({0.35, 0.35}, {far_box, box});
  core::Utime now = 0;
  for (const double x_m : {0.0, 0.7, 1.5, 0.6, 0.7}) {
    const BodyState bodies[] = {at(5.0), at(x_m)};
    contacts.update(now += 5000, 5000, bodies);
  }
  ASSERT_EQ(contacts.all().size(), 2U);
  EXPECT_EQ(contacts.all()[0].first, 1U);
  EXPECT_EQ(contacts.all()[0].second, 1U);
  EXPECT_TRUE(contacts.all()[0].with_obstacle);
  EXPECT_EQ(contacts.all()[0].duration_us, 10'000);
  EXPECT_NEAR(contacts.closestM(), -0.85, 1e-12) << "its centre inside, half a metre deep";
}

TEST(World, KnowsTheExperimentsObstacles) {
  config::Experiment experiment = vehicles(1);
  experiment.vehicles[0].start = config::Start{{0.0, 0.0}, 0.0};
  experiment.obstacles = {{"box", {{0.3, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {0.3, 1.0}}}};
  World world(experiment, kBegin);
  world.step();
  ASSERT_EQ(world.contacts().all().size(), 1U);
  EXPECT_TRUE(world.contacts().all()[0].with_obstacle);
}

TEST(World, CountsTimeInWholeSteps) {
  World world(vehicles(1), kBegin);
  for (int i = 0; i < 200; ++i) {
    world.step();
  }
  EXPECT_EQ(world.now(), kBegin + core::kMicrosPerSecond);
}

TEST(World, PushesOnlyTheNamedVehicleAndOnlyInItsTime) {
  config::Experiment experiment = vehicles(2);
  for (config::Vehicle& vehicle : experiment.vehicles) {
    vehicle.model = "unicycle";
  }
  experiment.sim.pushes.push_back({"hex2", 1.0, 0.5, {0.0, 2.0}});
  World world(experiment, kBegin);
  const Eigen::Vector3d first = world.bodies()[0].position_world_m;
  const Eigen::Vector3d second = world.bodies()[1].position_world_m;
  while (world.now() < kBegin + core::kMicrosPerSecond) {
    world.step();
  }
  EXPECT_EQ(world.bodies()[1].position_world_m, second);
  for (int i = 0; i < 400; ++i) {
    world.step();
  }
  EXPECT_EQ(world.bodies()[0].position_world_m, first);
  EXPECT_NEAR(world.bodies()[1].position_world_m.y() - second.y(), 0.25, 0.01);  // a t^2 / 2
}

TEST(World, VehiclesFlyThroughEachOtherButItIsCounted) {
  config::Experiment experiment = vehicles(2);
  for (std::size_t i = 0; i < 2; ++i) {
    experiment.vehicles[i].model = "unicycle";
    experiment.vehicles[i].start = config::Start{{2.0 * static_cast<double>(i), 0.0}, 0.0};
  }
  World world(experiment, kBegin);
  core::Command command;
  command.mode = core::CommandMode::kVelocity;
  command.velocity_world_mps.x() = 1.0;
  command.valid_for_s = 0.3;
  for (int i = 0; i < 40; ++i) {
    command.utime = world.now();
    world.accept(0, command);
    for (int k = 0; k < 20; ++k) {
      world.step();
    }
  }
  ASSERT_EQ(world.contacts().all().size(), 1U);
  EXPECT_NEAR(core::toSeconds(world.contacts().totalUs()), 1.4, 0.02);
}

TEST(World, StepAllocatesNothingInFlight) {
  World world(vehicles(6), kBegin);
  core::Command command;
  command.mode = core::CommandMode::kPosition;
  command.position_world_m.z() = 1.0;
  command.valid_for_s = 0.3;
  std::size_t before = 0;
  for (int i = 0; i < 100; ++i) {
    before = i == 50 ? test::allocationCount() : before;
    command.utime = world.now();
    world.accept(i % 6, command);
    world.step();
  }
  EXPECT_EQ(test::allocationCount(), before);
}

}  // namespace
}  // namespace roundabout::sim
