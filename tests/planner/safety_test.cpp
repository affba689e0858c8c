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

// hex1 in a small room, alone, as late as its bounds allow; its policy wants `wanted`.
class WallFlight {
 public:
  WallFlight() : flight_(smallRoom()), late_({0.0, 0.0}, 3.0, kLateSteps) {
    flight_.flyTo({1.0, 0.0, 1.0});
  }

  void start(const Eigen::Vector2d& place_m, const Eigen::Vector2d& velocity_mps) {
    late_ = LateVehicle(place_m, 3.0, kLateSteps);
    flight_.own().position_world_m.head<2>() = place_m;
    flight_.own().velocity_world_mps.head<2>() = velocity_mps;
  }

  // What leaves the planner when its policy wants a velocity. World.
  Eigen::Vector2d commandFor(const Eigen::Vector2d& wanted_mps) {
    flight_.script->decision = {.speed_mps = wanted_mps.norm(),
                                .heading_change_rad = std::atan2(wanted_mps.y(), wanted_mps.x())};
    return flight_.run(0.1).command.velocity_world_mps.head<2>();
  }

  // One planning period.
  void flyOn(const Eigen::Vector2d& command_mps) {
    for (int step = 0; step < 10; ++step) {
      late_.step(command_mps);
      wall_m_ = std::min(
          {wall_m_, 3.0 - std::abs(late_.position().x()), 2.0 - std::abs(late_.position().y())});
    }
    flight_.own().position_world_m.head<2>() = late_.position();
    flight_.own().velocity_world_mps.head<2>() = late_.velocity();
  }

  FakeFlight& flight() { return flight_; }
  // Of the centre, the closest so far. m.
  double wallM() const { return wall_m_; }

 private:
  static constexpr int kLateSteps = 32;

  static config::Experiment smallRoom() {
    config::Experiment experiment = threeVehicles();
    experiment.vehicles.resize(1);
    experiment.vehicles[0].preferred_speed_mps = 1.4;
    experiment.room.min_m = {-3.0, -2.0, 0.0};
    experiment.room.max_m = {3.0, 2.0, 3.0};
    experiment.planner.slow_down_distance_m = 0.3;
    experiment.shield.on = false;  // walls are kept all the same
    experiment.shield.multirotor = {0.32, 0.02, 0.0};
    experiment.planner.command_valid_s = 0.45;
    return experiment;
  }

  FakeFlight flight_;
  LateVehicle late_;
  double wall_m_ = std::numeric_limits<double>::infinity();
};

TEST(Walls, AVehicleThatObeysLateNeverTouchesThem) {
  core::RandomStream random(3, "room");
  WallFlight flight;
  for (int trial = 0; trial < 200; ++trial) {
    flight.flight().goal(core::GoalPhase::kGo, {trial % 2 == 0 ? 2.6 : -2.6, 1.6, 1.0}, 3 + trial);
    Eigen::Vector2d wanted;
    for (int tick = 0; tick < 100; ++tick) {
      if (tick % 10 == 0) {
        wanted = {random.uniform(-1, 1), random.uniform(-1, 1)};
      }
      flight.flyOn(flight.commandFor(wanted));
      ASSERT_GT(flight.wallM(), 0.35) << trial << " " << tick;
    }
  }
}

TEST(RoomGuard, SaysWhereToLand) {
  const RoomGuard guard(config::Room(), config::Vehicle(), 0.5);
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
