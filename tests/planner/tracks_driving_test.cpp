// A planner that knows others from its vehicle's own perception.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/safety/seen_agents.h"
#include "tests/planner/fake_flight.h"

namespace roundabout::planner {
namespace {

using core::CommandMode;
using Eigen::Vector2d;
using testing::HasSubstr;

core::AgentTracks tracksAt(core::Utime utime, const std::vector<core::AgentTrack>& tracks) {
  core::AgentTracks message;
  message.utime = utime;
  message.vehicle = "hex1";
  message.tracks = tracks;
  return message;
}

// Vector2d{} is no zero: it is anything.
const Vector2d kStill = Vector2d::Zero();

core::AgentTrack person(const Vector2d& place_m, const Vector2d& velocity_mps) {
  core::AgentTrack track;
  track.id = 3;
  track.agent_class = core::AgentClass::kPedestrian;
  track.position_world_m = place_m;
  track.velocity_world_mps = velocity_mps;
  track.radius_m = 0.3;
  return track;
}

// ---- what counts

config::Experiment byTracks() {
  config::Experiment experiment = threeVehicles();
  experiment.planner.others = "tracks";
  return experiment;
}

TEST(SeenAgents, TakeEffectAfterTheirTimeAndAreForgottenAfterTheirs) {
  SeenAgents seen(byTracks(), 0);
  seen.apply(100'000);
  EXPECT_FALSE(seen.fresh());
  ASSERT_EQ(seen.offer(tracksAt(200'000, {person({1.0, 0.0}, {1.0, 0.0})}), 150'000), nullptr);
  seen.apply(200'000);
  EXPECT_FALSE(seen.fresh()) << "as of the tick: for the next one";
  seen.apply(300'000);
  ASSERT_EQ(seen.agents().size(), 1u);
  EXPECT_NEAR(seen.agents()[0].position_m.x(), 1.1, 1e-9);
  EXPECT_NEAR(seen.agents()[0].age_s, 0.1, 1e-9);
  seen.apply(500'000);
  EXPECT_TRUE(seen.fresh());
  seen.apply(600'000);
  EXPECT_FALSE(seen.fresh());
  EXPECT_TRUE(seen.agents().empty());
}

TEST(SeenAgents, BlindTracksNeverCount) {
  SeenAgents seen(byTracks(), 0);
  core::AgentTracks blind = tracksAt(200'000, {person({1.0, 0.0}, kStill)});
  blind.health = core::PerceptionHealth::kBlind;
  blind.reason = "no scan for 0.4 s";
  seen.offer(blind, 0);
  seen.apply(250'000);
  EXPECT_FALSE(seen.fresh());
  EXPECT_EQ(seen.blindReason(), "no scan for 0.4 s");
  seen.offer(tracksAt(260'000, {}), 0);
  seen.apply(300'000);
  EXPECT_TRUE(seen.fresh());
  EXPECT_EQ(seen.blindReason(), "");
}

TEST(SeenAgents, WhoIsSlowStands) {
  SeenAgents seen(byTracks(), 0);
  core::AgentTrack furniture = person({0.0, 3.0}, {0.5, 0.0});
  furniture.agent_class = core::AgentClass::kStatic;
  seen.offer(
      tracksAt(1, {person({1.0, 0.0}, {0.15, 0.1}), person({2.0, 0.0}, {0.2, 0.1}), furniture}), 0);
  seen.apply(200'000);
  EXPECT_TRUE(seen.agents()[0].stands);
  EXPECT_EQ(seen.agents()[0].velocity_mps, Vector2d(0.0, 0.0));
  EXPECT_FALSE(seen.agents()[1].stands);
  EXPECT_TRUE(seen.agents()[2].stands);
}

TEST(SeenAgents, TheLessIsKnownOfSomebodyTheMoreRoomItGets) {
  const auto uncertainty = [](double deviation_m, double unseen_s, core::Utime now) {
    SeenAgents seen(byTracks(), 0);
    core::AgentTrack track = person({1.0, 0.0}, {1.0, 0.0});
    track.position_deviation_m = deviation_m;
    track.velocity_deviation_mps = 0.2;
    track.unseen_s = unseen_s;
    seen.offer(tracksAt(1, {track}), 0);
    seen.apply(now);
    return seen.agents()[0].uncertainty_m;
  };
  EXPECT_GT(uncertainty(0.1, 0.0, 100'000), uncertainty(0.02, 0.0, 100'000));
  EXPECT_GT(uncertainty(0.02, 0.4, 100'000), uncertainty(0.02, 0.0, 100'000));
  EXPECT_GT(uncertainty(0.02, 0.0, 250'000), uncertainty(0.02, 0.0, 100'000));
  EXPECT_LE(uncertainty(50.0, 9.0, 250'000), 0.5);
}

struct Surfaces : testing::Test {
  Surfaces() {  // the room ends at 5 m
    experiment.obstacles = {{"box", {{1.0, 3.0}, {2.0, 3.0}, {2.0, 4.0}, {1.0, 4.0}}}};
    experiment.vehicles[0].lidar.emplace().sees_room_walls = true;
  }

  bool isSomebody(core::AgentTrack track) const {
    track.position_deviation_m = 0.03;
    SeenAgents seen(experiment, 0);
    seen.offer(tracksAt(1, {track}), 0);
    seen.apply(100'000);
    return !seen.agents().empty();
  }

  config::Experiment experiment = byTracks();
};

TEST_F(Surfaces, WhatIsDeepInAWallOrInFurnitureIsNobody) {
  EXPECT_FALSE(isSomebody(person({7.0, 0.0}, {-1.0, 0.0})));
  EXPECT_FALSE(isSomebody(person({1.5, 3.5}, {0.0, -1.0})));
}

TEST_F(Surfaces, WhoLeansOnFurnitureOrOnAWallIsSomebody) {
  EXPECT_TRUE(isSomebody(person({1.5, 2.95}, kStill)));
  EXPECT_TRUE(isSomebody(person({1.5, 3.05}, kStill))) << "it is measured that well";
  EXPECT_TRUE(isSomebody(person({4.95, 0.0}, kStill)));
}

TEST_F(Surfaces, WhatStandsAtOneAndIsNoPersonIsAPieceOfIt) {
  core::AgentTrack track = person({1.5, 2.95}, kStill);
  for (const core::AgentClass what : {core::AgentClass::kUnknown, core::AgentClass::kStatic}) {
    track.agent_class = what;
    EXPECT_FALSE(isSomebody(track));
  }
  track.agent_class = core::AgentClass::kUnknown;
  track.velocity_world_mps = {0.8, 0.0};
  EXPECT_TRUE(isSomebody(track)) << "it moves";
}

TEST_F(Surfaces, PeopleWalkInOverTheEdgeOfARoomWithoutWalls) {
  experiment.vehicles[0].lidar->sees_room_walls = false;
  EXPECT_TRUE(isSomebody(person({5.3, 0.0}, {-1.0, 0.0})));
}

TEST(SeenAgents, RefuseStampsOfNoSuchTimeAndOlderOnesThanBefore) {
  SeenAgents seen(byTracks(), 0);
  EXPECT_NE(seen.offer(tracksAt(-1, {}), 0), nullptr);
  EXPECT_NE(seen.offer(tracksAt(3600 * core::kMicrosPerSecond, {}), 1'000'000), nullptr);
  EXPECT_EQ(seen.offer(tracksAt(900'000, {}), 1'000'000), nullptr);
  seen.apply(1'000'000);
  EXPECT_NE(seen.offer(tracksAt(800'000, {}), 1'000'000), nullptr);
}

// ---- the planner

struct SeeingFlight : FakeFlight {
  explicit SeeingFlight(const std::string& others = "tracks") : FakeFlight(robotBy(others)) {
    vehicles[0].position_world_m = {0.0, 0.0, 0.0};
  }

  static config::Experiment robotBy(const std::string& others) {
    config::Experiment experiment = threeVehicles();
    experiment.planner.others = others;
    experiment.vehicles[0].model = "ground_robot";
    return experiment;
  }

  void drive() {
    run(0.1);
    goal(core::GoalPhase::kGo, {4.0, 0.0, 0.0});
    run(0.1);
  }
  const char* see(const std::vector<core::AgentTrack>& tracks) {
    return core.onTracks(tracksAt(now, tracks));
  }
};

TEST(DrivingByTracks, HoldsWithoutTracksSaysWhyAndCounts) {
  SeeingFlight flight;
  flight.drive();
  const PlannerCore::Tick blind = flight.run(0.2);
  EXPECT_EQ(blind.status.mode, Mode::kHolding);
  EXPECT_EQ(blind.status.reason, "no tracks from perception");
  EXPECT_EQ(blind.command.mode, CommandMode::kHold);
  const int counted = blind.status.ticks_without_tracks;
  EXPECT_GE(counted, 2);
  flight.see({});
  EXPECT_EQ(flight.run(0.1).status.mode, Mode::kFlying);
  flight.run(0.2);
  EXPECT_EQ(flight.run(0.2).status.mode, Mode::kHolding) << "perception is silent";
  EXPECT_GT(flight.ticks.back().status.ticks_without_tracks, counted);
}

TEST(DrivingByTracks, ThePolicySeesTracksInsteadOfVehicles) {
  SeeingFlight flight;
  flight.see({person({1.5, 0.5}, {0.0, -1.0})});
  flight.drive();
  flight.see({person({1.5, 0.5}, {0.0, -1.0})});
  const PlannerCore::Tick tick = flight.run(0.1);
  ASSERT_EQ(flight.script->others.size(), 1u);
  const core::OtherAgent& seen = flight.script->others[0];
  EXPECT_NEAR(seen.position_world_m.y(), 0.5 - tick.status.tracks_age_s, 1e-9);
  EXPECT_EQ(seen.velocity_world_mps, Vector2d(0.0, -1.0));
  EXPECT_GE(seen.radius_m, 0.3);
  EXPECT_EQ(seen.id, SeenAgent::kFirstId + 3);
  EXPECT_EQ(tick.status.tracks_used, 1);
}

TEST(DrivingByTracks, WithBothAVehicleThatIsSeenTooCountsOnce) {
  SeeingFlight flight("both");
  const auto see = [&] {  // hex2 is at (3, 0)
    flight.see({person({3.05, 0.0}, {0.0, 0.0}), person({0.0, 2.0}, {0.0, 0.0})});
  };
  see();
  flight.drive();
  see();
  flight.run(0.1);
  EXPECT_EQ(flight.script->others.size(), 3u) << "hex2, hex3 and the person at (0, 2)";
}

TEST(DrivingByTracks, WithBothSomebodyWhoStandsByAVehicleCountsToo) {
  SeeingFlight flight("both");
  const auto see = [&] {  // hex2 is at (3, 0), and its body reaches 0.35 m
    flight.see({person({3.0, 0.6}, {0.0, 0.0})});
  };
  see();
  flight.drive();
  see();
  flight.run(0.1);
  EXPECT_EQ(flight.script->others.size(), 3u) << "hex2, hex3 and the person beside hex2";
}

TEST(DrivingByTracks, WithBothTheSeparationIsToOtherThingsThanTheVehicleItself) {
  SeeingFlight flight("both");
  const auto see = [&] { flight.see({person({2.7, 0.0}, {0.0, 0.0})}); };
  see();
  flight.drive();
  see();
  const PlannerCore::Tick tick = flight.run(0.1);
  const double apart_m = 3.0 - flight.vehicles[0].position_world_m.x();
  EXPECT_NEAR(tick.status.closest_separation_m, apart_m - 2.0 * 0.35, 1e-6);
}

TEST(DrivingByTracks, TheShieldStopsBeforeAPersonWhateverThePolicyWants) {
  SeeingFlight flight;
  flight.script->decision.speed_mps = 0.5;
  const std::vector<core::AgentTrack> ahead = {person({0.95, 0.0}, {0.0, 0.0})};
  flight.see(ahead);
  flight.drive();
  flight.see(ahead);
  const PlannerCore::Tick tick = flight.run(0.1);
  EXPECT_NE(tick.status.shield.layer, core::ShieldLayer::kNone);
  EXPECT_LT(tick.command.velocity_world_mps.x(), 0.4);
}

TEST(DrivingByTracks, WhoDrivesByStatesNeedsNone) {
  SeeingFlight flight("states");
  flight.drive();
  EXPECT_EQ(flight.run(0.2).status.mode, Mode::kFlying);
  EXPECT_TRUE(std::isnan(flight.ticks.back().status.tracks_age_s));
}

}  // namespace
}  // namespace roundabout::planner
