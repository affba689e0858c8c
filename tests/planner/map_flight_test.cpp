// A planner that is told what stands around it.

#include <algorithm>
#include <array>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "tests/planner/fake_flight.h"
#include "tests/planner/occupied_cells.h"

namespace roundabout::planner {
namespace {

/// 1.5 m ahead, from 2 m to the right to 0.5 m to the left.
core::OccupancyMap wallAhead() {
  std::vector<test::CellKey> cells;
  for (int y = -20; y < 5; ++y) {
    cells.push_back({15, y});
  }
  return test::mapOf(cells);
}

TEST(MapFlight, SendsThePolicyRoundAWall) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.run(0.1);
  EXPECT_TRUE(flight.script->ego.goal_world_m.isApprox(Eigen::Vector2d(4.0, 0.0)));
  EXPECT_EQ(flight.core.onMap(wallAhead()), nullptr);
  flight.run(0.1);
  const Eigen::Vector2d towards = flight.script->ego.goal_world_m;
  EXPECT_GT(towards.y(), 0.5) << towards.transpose();
}

TEST(MapFlight, DoesNotFlyWhatWouldHitTheWall) {
  FakeFlight flight;
  flight.script->decision = {.speed_mps = 0.5, .heading_change_rad = 0.0};
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.x() = 0.8;
  flight.run(0.1);
  EXPECT_NEAR(flight.run(0.1).command.velocity_world_mps.y(), 0.0, 1e-9);
  ASSERT_EQ(flight.core.onMap(wallAhead()), nullptr);
  const Eigen::Vector3d flown = flight.run(0.1).command.velocity_world_mps;
  // 0.35 m of body and 0.05 m of margin before the wall at 1.5 m, within the next second.
  EXPECT_LT(0.8 + flown.x(), 1.1 + 0.06);
}

TEST(MapFlight, TakesEffectAtTheFirstTickAfterItsTime) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.run(0.1);
  const auto sentStraight = [&] {
    return flight.script->ego.goal_world_m.isApprox(Eigen::Vector2d(4.0, 0.0));
  };
  core::OccupancyMap map = wallAhead();
  map.utime = flight.ticks.back().status.utime + 100'000;  // of the next tick
  ASSERT_EQ(flight.core.onMap(map), nullptr);
  flight.run(0.1);
  ASSERT_EQ(flight.ticks.back().status.utime, map.utime);
  EXPECT_TRUE(sentStraight());
  flight.run(0.1);
  EXPECT_FALSE(sentStraight());
}

TEST(MapFlight, AnOlderMapThatComesLateChangesNothing) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.run(0.1);
  core::OccupancyMap wall = wallAhead();
  wall.utime = flight.now;
  core::OccupancyMap open = test::mapOf({});
  open.utime = wall.utime - 1;
  ASSERT_EQ(flight.core.onMap(wall), nullptr);
  flight.run(0.1);
  ASSERT_EQ(flight.core.onMap(open), nullptr);
  flight.run(0.1);
  EXPECT_GT(flight.script->ego.goal_world_m.y(), 0.5);
}

TEST(MapFlight, RefusesATimeFarAhead) {
  FakeFlight flight;
  flight.run(0.1);
  core::OccupancyMap map = wallAhead();
  map.utime = flight.now + 3'600 * core::kMicrosPerSecond;
  EXPECT_STREQ(flight.core.onMap(map), "its time stamp is corrupt");
}

/// The wall ahead is likeliest; then, in this order, a little to the right of that, back, and to
/// the left.
struct ActionTable {
  static constexpr std::array<DiscreteAction, 4> kActions = {
      {{1.0, 0.0}, {1.0, -0.2}, {0.5, std::numbers::pi}, {1.0, std::numbers::pi / 2.0}}};
  static constexpr std::array kProbabilities = {0.5F, 0.3F, 0.15F, 0.05F};
};

TEST(MapFlight, FliesTheLikeliestActionThatDoesNotHitTheWall) {
  FakeFlight flight;
  flight.script->decision = {.speed_mps = 0.5,
                             .heading_change_rad = 0.0,
                             .action = 0,
                             .action_probabilities = ActionTable::kProbabilities,
                             .actions = ActionTable::kActions};
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.x() = 0.8;
  const PlannerCore::Tick free = flight.run(0.1);
  EXPECT_EQ(free.status.decision.action, 0);
  ASSERT_EQ(flight.core.onMap(wallAhead()), nullptr);
  const PlannerCore::Tick masked = flight.run(0.1);
  // A little to the right hits it too; the nearest free direction would be to the left.
  EXPECT_EQ(masked.status.decision.action, 2);
  EXPECT_NEAR(masked.command.velocity_world_mps.x(), -0.25, 1e-6);
  EXPECT_NEAR(masked.command.velocity_world_mps.y(), 0.0, 1e-6);
}

TEST(MapFlight, CountsAMapThatIsNone) {
  FakeFlight flight;
  core::OccupancyMap map = wallAhead();
  map.tree.pop_back();
  EXPECT_STREQ(flight.core.onMap(map), "its tree is cut off, or too long");
  EXPECT_EQ(flight.run(0.1).status.rejected_messages, 1);
}

TEST(MapFlight, RefusesATreeOfAnotherResolutionThanItSays) {
  FakeFlight flight;
  core::OccupancyMap map = wallAhead();
  map.resolution_m = 0.05;
  EXPECT_STREQ(flight.core.onMap(map), "its resolution is not that of its tree");
}

/// 1.5 m ahead, through the whole room: there is no way round.
core::OccupancyMap longWall() {
  std::vector<test::CellKey> cells;
  for (int y = -50; y < 50; ++y) {
    cells.push_back({15, y});
  }
  return test::mapOf(cells);
}

// Cells of 0.1 m, the wall's first from 1.5 m on.
constexpr double kFace_m = 1.5;

// Somebody comes along from behind, and does not look where it goes.
TEST(MapFlight, AtItsGoalNothingDrivesItIntoTheWall) {
  config::Experiment experiment = threeVehicles();
  experiment.vehicles[1].shielded = false;
  FakeFlight flight(experiment);
  flight.own().position_world_m.x() = kFace_m - 0.35 - 0.05;
  flight.flyTo({flight.own().position_world_m.x(), 0.0, 1.0});
  core::VehicleState& comes = flight.vehicles[1];
  comes.position_world_m = {-2.0, 0.3, 1.0};
  comes.velocity_world_mps = {0.8, 0.0, 0.0};
  bool moved = false;
  for (int i = 0; i < 40; ++i) {
    core::OccupancyMap map = longWall();
    map.utime = flight.now;
    ASSERT_EQ(flight.core.onMap(map), nullptr);
    const PlannerCore::Tick tick = flight.run(0.1);
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    if (tick.command.mode == core::CommandMode::kVelocity) {
      velocity = tick.command.velocity_world_mps;
      moved = moved || (tick.status.mode == Mode::kAtGoal && velocity.norm() > 0.1);
    }
    flight.own().velocity_world_mps = velocity;
    flight.own().position_world_m += 0.1 * velocity;
    comes.position_world_m.x() += 0.08;
    ASSERT_LT(flight.own().position_world_m.x(), kFace_m - 0.35) << "after " << i;
  }
  EXPECT_TRUE(moved) << "or this shows nothing";
}

TEST(MapFlight, NoLayerOfTheShieldFliesIntoTheWall) {
  FakeFlight flight;  // somebody is parked behind it
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.x() = 0.5;
  std::set<core::ShieldLayer> layers;
  for (int i = 0; i < 200; ++i) {
    core::OccupancyMap map = longWall();
    map.utime = flight.now;
    ASSERT_EQ(flight.core.onMap(map), nullptr);
    const PlannerCore::Tick tick = flight.run(0.1);
    ASSERT_EQ(tick.status.mode, Mode::kFlying) << tick.status.reason;
    layers.insert(tick.status.shield.layer);
    const Eigen::Vector2d velocity = tick.command.velocity_world_mps.head<2>();
    flight.own().velocity_world_mps = tick.command.velocity_world_mps;
    flight.own().position_world_m.head<2>() += 0.1 * velocity;
    // Ideal motion: the body keeps the shield's margin to the face of the wall.
    ASSERT_LT(flight.own().position_world_m.x(), kFace_m - 0.35 - 0.1 + 0.01)
        << "after " << i << " ticks";
  }
  EXPECT_TRUE(layers.contains(core::ShieldLayer::kBreaker)) << "or this shows nothing";
}

}  // namespace
}  // namespace roundabout::planner
