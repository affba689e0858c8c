#include <cmath>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "planner/command_law.h"
#include "planner/safety/order_latch.h"
#include "planner/safety/room_guard.h"
#include "planner/safety/tracks.h"
#include "tests/planner/fake_flight.h"

namespace roundabout::planner {
namespace {

core::VehicleState bodyAt(double x, double y = 0.0, const std::string& name = "hex1") {
  core::VehicleState state;
  state.name = name;
  state.position_world_m = {x, y, 1.0};
  state.tracked = true;
  return state;
}

class TrackTest : public ::testing::Test {
 protected:
  bool see(double x) { return track_.update(bodyAt(x), now_ += 5'000); }

  Track track_{2.0, config::Safety()};
  core::Utime now_ = 1'000'000;
};

TEST_F(TrackTest, FollowsAVehicleAtItsTopSpeed) {
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(see(0.01 * i));
  }
  EXPECT_EQ(track_.rejected(), 0);
}

TEST_F(TrackTest, RejectsAJumpAndGoesOn) {
  see(0.0);
  EXPECT_FALSE(see(0.2));
  EXPECT_TRUE(see(0.0));
  EXPECT_EQ(track_.rejected(), 1);
  EXPECT_DOUBLE_EQ(track_.ageS(now_), 0.0);
}

TEST_F(TrackTest, IsLostAfterTenRejectsInARow) {
  see(0.0);
  for (int i = 0; i < 9; ++i) {
    EXPECT_FALSE(see(5.0 + 5.0 * (i % 2)));
    EXPECT_FALSE(track_.lost());
  }
  see(5.0);
  EXPECT_TRUE(track_.lost());
  EXPECT_TRUE(std::isinf(track_.ageS(now_)));
}

TEST_F(TrackTest, StartsAnewWhereMeasurementsAgree) {
  see(0.0);
  int frames = 0;
  while (!see(5.0) && frames < 100) {
    ++frames;
  }
  EXPECT_LE(frames, 12);
  EXPECT_FALSE(track_.lost());
  EXPECT_DOUBLE_EQ(track_.state().position_world_m.x(), 5.0);
}

TEST_F(TrackTest, DoesNotStartAnewWhereTheyDoNot) {
  see(0.0);
  for (int i = 0; i < 200; ++i) {
    see(5.0 * (1 + i % 3));
  }
  EXPECT_TRUE(track_.lost());
}

TEST(TrackTable, ExchangedBodiesAreNeverBelieved) {
  TrackTable tracks(threeVehicles());
  core::StatesFrame frame;
  frame.vehicles = {bodyAt(0.0, 0.0, "hex1"), bodyAt(1.2, 0.0, "hex2")};
  for (int i = 0; i < 20; ++i) {
    frame.utime += 5'000;
    tracks.update(frame);
  }
  std::swap(frame.vehicles[0].position_world_m, frame.vehicles[1].position_world_m);
  for (int i = 0; i < 400; ++i) {  // 2 s: their top speed would have taken them there
    frame.utime += 5'000;
    tracks.update(frame);
  }
  EXPECT_DOUBLE_EQ(tracks.at(0).state().position_world_m.x(), 0.0);
  EXPECT_DOUBLE_EQ(tracks.at(1).state().position_world_m.x(), 1.2);
  EXPECT_TRUE(tracks.at(0).lost());
  EXPECT_EQ(tracks.rejectedMeasurements(), 800);
}

TEST(TrackTable, AnExchangeThatEndsIsForgiven) {
  TrackTable tracks(threeVehicles());
  core::StatesFrame frame;
  frame.vehicles = {bodyAt(0.0, 0.0, "hex1"), bodyAt(1.2, 0.0, "hex2")};
  const auto run = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      frame.utime += 5'000;
      tracks.update(frame);
    }
  };
  run(20);
  std::swap(frame.vehicles[0].position_world_m, frame.vehicles[1].position_world_m);
  run(5);
  std::swap(frame.vehicles[0].position_world_m, frame.vehicles[1].position_world_m);
  run(1);
  EXPECT_DOUBLE_EQ(tracks.at(0).ageS(frame.utime), 0.0);
  EXPECT_DOUBLE_EQ(tracks.at(1).ageS(frame.utime), 0.0);
}

TEST(RoomGuard, AVehicleThatObeysNeverLeavesTheRoom) {
  config::Room room;
  room.min_m = {-3.0, -2.0, 0.0};
  room.max_m = {3.0, 2.0, 3.0};
  config::Vehicle vehicle;
  const double reaction_s = 0.42;
  const RoomGuard guard(room, vehicle, 0.5, reaction_s);
  core::RandomStream random(3, "room");
  for (int flight = 0; flight < 200; ++flight) {
    Eigen::Vector3d position(random.uniform(-2, 2), random.uniform(-1, 1), 1.0);
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector2d wanted;
    for (int tick = 0; tick < 100; ++tick) {
      if (tick % 10 == 0) {
        wanted = {random.uniform(-2, 2), random.uniform(-2, 2)};
      }
      const Eigen::Vector2d clipped = guard.clipVelocity(position, velocity, wanted);
      // A vehicle that ignores the command for a tick, then reaches it with its acceleration.
      for (int step = 0; step < 10; ++step) {
        const Eigen::Vector2d missing = clipped - velocity.head<2>();
        velocity.head<2>() +=
            missing.normalized() * std::min(missing.norm(), vehicle.max_acceleration_mps2 * 0.01);
        position += velocity * 0.01;
      }
      ASSERT_TRUE(guard.inside(position.head<2>())) << position.transpose();
    }
  }
}

TEST(RoomGuard, LeavesVelocitiesInTheMiddleAlone) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5, 0.4);
  const Eigen::Vector2d wanted(1.2, -0.7);
  EXPECT_EQ(guard.clipVelocity({0, 0, 1}, {1, 0, 0}, wanted), wanted);
}

TEST(RoomGuard, LetsAVehicleOutsideComeBack) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5, 0.4);
  EXPECT_EQ(guard.clipVelocity({10.2, 0, 1}, {0, 0, 0}, {-0.5, 0.0}), Eigen::Vector2d(-0.5, 0.0));
  EXPECT_EQ(guard.clipVelocity({10.2, 0, 1}, {0, 0, 0}, {0.5, 0.0}), Eigen::Vector2d(0.0, 0.0));
  EXPECT_FALSE(guard.mustLand({10.2, 0, 1}));
  EXPECT_TRUE(guard.mustLand({10.6, 0, 1}));
  EXPECT_TRUE(guard.mustLand({0, 0, 4.6}));
  EXPECT_FALSE(guard.mustLand({0, 0, -0.6}));
}

struct LatchCase {
  Latch from;
  core::SafetyOrderKind order;
  Latch to;
};

TEST(OrderLatch, FollowsItsTable) {
  using core::SafetyOrderKind;
  const LatchCase cases[] = {
      {Latch::kNone, SafetyOrderKind::kHold, Latch::kHold},
      {Latch::kNone, SafetyOrderKind::kLand, Latch::kLand},
      {Latch::kNone, SafetyOrderKind::kKill, Latch::kKill},
      {Latch::kHold, SafetyOrderKind::kLand, Latch::kLand},
      {Latch::kHold, SafetyOrderKind::kKill, Latch::kKill},
      {Latch::kHold, SafetyOrderKind::kResume, Latch::kNone},
      {Latch::kLand, SafetyOrderKind::kHold, Latch::kHold},
      {Latch::kLand, SafetyOrderKind::kKill, Latch::kKill},
      {Latch::kLand, SafetyOrderKind::kResume, Latch::kNone},
      {Latch::kKill, SafetyOrderKind::kHold, Latch::kKill},
      {Latch::kKill, SafetyOrderKind::kLand, Latch::kKill},
      {Latch::kKill, SafetyOrderKind::kResume, Latch::kNone},
  };
  for (const LatchCase& c : cases) {
    OrderLatch latch;
    latch.fault(c.from, "set up");
    latch.order(c.order);
    EXPECT_EQ(latch.state(), c.to) << static_cast<int>(c.from) << " " << static_cast<int>(c.order);
  }
}

TEST(OrderLatch, AFaultNeverLowersTheState) {
  for (const Latch from : {Latch::kNone, Latch::kHold, Latch::kLand, Latch::kKill}) {
    for (const Latch fault : {Latch::kHold, Latch::kLand}) {
      OrderLatch latch;
      latch.fault(from, "first");
      latch.fault(fault, "second");
      EXPECT_EQ(latch.state(), std::max(from, fault));
    }
  }
}

class CommandLawTest : public ::testing::Test {
 protected:
  CommandLawTest() {
    ego_.preferred_speed_mps = 1.0;
    ego_.heading_world_rad = 0.2;
  }
  PlanarCommand at(double distance_m, const Decision& decision) {
    ego_.goal_world_m = {distance_m, 0.0};
    return commandFrom(decision, ego_, settings_);
  }

  core::EgoAgent ego_;
  config::Planner settings_;
  Decision turn_{.speed_mps = 1.0, .heading_change_rad = 0.5, .action = 4};
};

TEST_F(CommandLawTest, FarFromTheGoalItIsTheDecision) {
  const PlanarCommand command = at(2.0, turn_);
  EXPECT_NEAR(command.velocity_world_mps.norm(), 1.0, 1e-12);
  EXPECT_NEAR(command.heading_world_rad, 0.7, 1e-12);
  EXPECT_NEAR(std::atan2(command.velocity_world_mps.y(), command.velocity_world_mps.x()), 0.7,
              1e-12);
}

TEST_F(CommandLawTest, SpeedAndTurnShrinkLinearlyNearTheGoal) {
  for (const double distance_m : {1.5, 1.0, 0.5, 0.31}) {
    const PlanarCommand command = at(distance_m, turn_);
    EXPECT_NEAR(command.velocity_world_mps.norm(), distance_m / 2.0, 1e-12);
    EXPECT_NEAR(command.heading_world_rad, 0.2 + 0.5 * distance_m / 2.0, 1e-12);
  }
}

TEST_F(CommandLawTest, AVelocityFromAContinuousPolicyKeepsItsDirection) {
  turn_.action = -1;
  const PlanarCommand command = at(0.5, turn_);
  EXPECT_NEAR(command.velocity_world_mps.norm(), 0.25, 1e-12);
  EXPECT_NEAR(command.heading_world_rad, 0.7, 1e-12);
}

TEST_F(CommandLawTest, PositionControlBeginsAtThirtyCentimetres) {
  ego_.goal_world_m = {0.3, 0.0};
  EXPECT_TRUE(holdsPosition(ego_, settings_));
  ego_.goal_world_m = {0.301, 0.0};
  EXPECT_FALSE(holdsPosition(ego_, settings_));
}

}  // namespace
}  // namespace roundabout::planner
