#include <cmath>
#include <deque>

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

TEST_F(TrackTest, RejectsAVelocityThatNoVehicleHas) {
  see(0.0);
  core::VehicleState fast = bodyAt(0.0);
  fast.velocity_world_mps.x() = 1e9;
  EXPECT_FALSE(track_.update(fast, now_ += 5'000));
  EXPECT_TRUE(see(0.0));
}

TEST_F(TrackTest, IsNotExtrapolatedForEver) {
  core::VehicleState moving = bodyAt(0.0);
  moving.velocity_world_mps.x() = 1.0;
  track_.update(moving, now_);
  EXPECT_NEAR(track_.positionAt(now_ + 500'000).x(), 0.5, 1e-9);
  EXPECT_NEAR(track_.positionAt(now_ + 60'000'000).x(), 1.0, 1e-9);
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

// Obeys commands that are as late as the guard was told, and then with all its acceleration.
class LateVehicle {
 public:
  static constexpr double kStep_s = 0.01;

  LateVehicle(const Eigen::Vector2d& position, double max_acceleration_mps2, int late_steps)
      : position_(position),
        max_change_mps_(max_acceleration_mps2 * kStep_s),
        commands_(static_cast<std::size_t>(late_steps), Eigen::Vector2d::Zero()) {}

  void step(const Eigen::Vector2d& command) {
    commands_.push_back(command);
    const Eigen::Vector2d missing = commands_.front() - velocity_;
    commands_.pop_front();
    velocity_ += missing.normalized() * std::min(missing.norm(), max_change_mps_);
    position_ += velocity_ * kStep_s;
  }

  const Eigen::Vector2d& position() const { return position_; }
  const Eigen::Vector2d& velocity() const { return velocity_; }

 private:
  Eigen::Vector2d position_;
  Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();
  double max_change_mps_;
  std::deque<Eigen::Vector2d> commands_;
};

TEST(RoomGuard, AVehicleThatObeysLateNeverLeavesTheRoom) {
  config::Room room;
  room.min_m = {-3.0, -2.0, 0.0};
  room.max_m = {3.0, 2.0, 3.0};
  const config::Vehicle vehicle;
  const RoomGuard guard(room, vehicle, 0.5, 0.42);
  core::RandomStream random(3, "room");
  for (int flight = 0; flight < 2000; ++flight) {
    // Ten steps pass until the next command: the rest of 0.42 s is how late commands are.
    LateVehicle late({random.uniform(-2, 2), random.uniform(-1, 1)}, vehicle.max_acceleration_mps2,
                     32);
    Eigen::Vector2d wanted;
    for (int tick = 0; tick < 100; ++tick) {
      if (tick % 10 == 0) {
        wanted = {random.uniform(-1, 1), random.uniform(-1, 1)};
      }
      const Eigen::Vector2d clipped = guard.clipVelocity(late.position(), late.velocity(), wanted);
      for (int step = 0; step < 10; ++step) {
        late.step(clipped);
        ASSERT_TRUE(guard.inside(late.position())) << late.position().transpose();
      }
    }
  }
}

TEST(RoomGuard, LeavesVelocitiesInTheMiddleAlone) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5, 0.4);
  const Eigen::Vector2d wanted(1.2, -0.7);
  EXPECT_EQ(guard.clipVelocity({0, 0}, {1, 0}, wanted), wanted);
}

TEST(RoomGuard, AtTheWallAPolicyThatStopsForSomebodyIsObeyed) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5, 0.4);
  // The wall is at x = 10; somebody is ahead in y.
  const Eigen::Vector2d clipped = guard.clipVelocity({9.55, 0.0}, {0.4, 0.25}, {0.0, 0.0});
  EXPECT_EQ(clipped, Eigen::Vector2d::Zero());
}

TEST(RoomGuard, AtTheWallAPolicyThatTurnsBackBrakesAtLeastAsMuchAsOneThatStops) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5, 0.4);
  for (const double along_mps : {1.0, -1.0, 0.2}) {
    // Next to the wall at x = 10, with a little speed toward it.
    const auto after = [&](double wanted_mps) {
      return guard.clipVelocity({9.6, 0.0}, {0.02, along_mps}, {0.0, wanted_mps}).y();
    };
    EXPECT_LT(std::abs(after(0.0)), std::max(0.71 * std::abs(along_mps), 1e-9));
    EXPECT_LE(after(-along_mps) * along_mps, after(0.0) * along_mps);
    EXPECT_NEAR(after(2.0 * along_mps), along_mps + std::copysign(0.02, along_mps), 1e-9)
        << "faster along the wall only as far as braking leaves room";
  }
}

TEST(RoomGuard, LetsAVehicleOutsideComeBack) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5, 0.4);
  EXPECT_EQ(guard.clipVelocity({10.2, 0}, {0, 0}, {-0.5, 0.0}), Eigen::Vector2d(-0.5, 0.0));
  EXPECT_EQ(guard.clipVelocity({10.2, 0}, {0, 0}, {0.5, 0.0}), Eigen::Vector2d(0.0, 0.0));
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

TEST(OrderLatch, ALateOrderNeverLowersTheState) {
  OrderLatch latch;
  latch.order(core::SafetyOrderKind::kLand);
  latch.raise(core::SafetyOrderKind::kHold);
  EXPECT_EQ(latch.state(), Latch::kLand);
  latch.raise(core::SafetyOrderKind::kKill);
  EXPECT_EQ(latch.state(), Latch::kKill);
}

TEST(OrderLatch, ARemarkIsSaidOnceAndEndsWithTheLatch) {
  OrderLatch latch;
  latch.remark("nobody is held");
  EXPECT_EQ(latch.reason(), "");
  latch.order(core::SafetyOrderKind::kHold);
  latch.remark("by the way");
  latch.remark("by the way");
  EXPECT_EQ(latch.reason(), "ordered to hold; by the way");
  latch.order(core::SafetyOrderKind::kResume);
  EXPECT_EQ(latch.reason(), "");
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
