// People: how they walk, who is recorded, whom they meet.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "sim/pedestrians/crowd.h"
#include "sim/pedestrians/encounters.h"
#include "sim/pedestrians/recording.h"
#include "sim/world.h"
#include "tests/support/reference.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::sim {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr core::Utime kBegin = core::kMicrosPerSecond;
constexpr double kStepS = 0.005;

// ---- legs and gait

TEST(Pedestrian, LegsStandSideBySideAndStepOneBeforeTheOther) {
  Pedestrian person;
  person.gait_rad = 1.0;
  EXPECT_EQ(legsOf(person)[0].x(), 0.0);
  EXPECT_NEAR((legsOf(person)[0] - legsOf(person)[1]).norm(), 0.2, 1e-9);
  person.velocity_mps = {1.4, 0.0};
  double longest_m = 0.0;
  for (double t = 0.0; t < 2.0; t += kStepS) {
    walk(person, kStepS);
    const auto legs = legsOf(person);
    longest_m = std::max(longest_m, std::abs(legs[0].x() - legs[1].x()));
    EXPECT_LT((0.5 * (legs[0] + legs[1]) - person.position_m).norm(), 1e-12);
  }
  EXPECT_NEAR(longest_m, 0.7, 0.01);  // half a stride
}

// ---- a crowd

config::Experiment room(int people) {
  config::Experiment experiment;
  experiment.file = "test";
  config::Vehicle robot;
  robot.name = "rover";
  robot.model = "ground_robot";
  robot.body_radius_m = 0.25;
  robot.start = config::Start{{-8.0, 0.0}, 0.0};
  experiment.vehicles = {robot};
  experiment.pedestrians.count = people;
  experiment.pedestrians.area = {{-3.0, -3.0}, {3.0, 3.0}};
  return experiment;
}

int standing(const World& world) {
  int count = 0;
  for (const Pedestrian& person : world.people()) {
    count += person.velocity_mps.norm() < kPedestrianStandsMps ? 1 : 0;
  }
  return count;
}

TEST(Crowd, SoManyStandAndTheRolesChange) {
  config::Experiment experiment = room(6);
  experiment.pedestrians.standing_share = 0.5;
  experiment.pedestrians.role_change_s = 3.0;
  World world(experiment, kBegin);
  std::set<std::int32_t> stood;
  int most = 0;
  for (int i = 0; i < 60 * 200; ++i) {
    world.step();
    if (i > 600 && i % 100 == 0) {
      most = std::max(most, standing(world));
      for (const Pedestrian& person : world.people()) {
        if (person.velocity_mps.norm() < 1e-3) {
          stood.insert(person.id);
        }
      }
    }
  }
  EXPECT_EQ(world.people().size(), 6u);
  EXPECT_EQ(stood.size(), 6u) << "in a minute everybody stands some time";
  EXPECT_LE(most, 5);
}

TEST(Crowd, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto after = [](std::uint64_t seed) {
    config::Experiment experiment = room(5);
    experiment.seed = seed;
    World world(experiment, kBegin);
    for (int i = 0; i < 1000; ++i) {
      world.step();
    }
    return world.people()[4].position_m;
  };
  EXPECT_EQ(after(1), after(1));
  EXPECT_NE(after(1), after(2));
}

TEST(Crowd, NobodyBeginsNearAVehicleAndATooSmallAreaIsRefused) {
  config::Experiment experiment = room(8);
  experiment.vehicles[0].start = config::Start{{0.0, 0.0}, 0.0};
  const World world(experiment, kBegin);
  for (const Pedestrian& person : world.people()) {
    EXPECT_GE(person.position_m.norm(), experiment.pedestrians.clear_of_vehicles_m);
  }
  experiment.pedestrians.area = {{-0.5, -0.5}, {0.5, 0.5}};
  try {
    const World full(experiment, kBegin);
    FAIL() << "placed eight people beside a robot";
  } catch (const core::StartupError& error) {
    EXPECT_THAT(error.what(), HasSubstr("pedestrians.area"));
  }
}

// Two who walk at each other pass, at a distance that points could not be told to keep.
TEST(SocialForce, TwoWhoMeetPassEachOther) {
  SocialForce force;
  core::EgoAgent a;
  core::EgoAgent b;
  a.position_world_m = {-3.0, 0.02};
  a.goal_world_m = {3.0, 0.0};
  b.position_world_m = {3.0, -0.02};
  b.goal_world_m = {-3.0, 0.0};
  a.preferred_speed_mps = b.preferred_speed_mps = 1.0;
  double closest_m = 10.0;
  for (int i = 0; i < 80; ++i) {
    const core::OtherAgent of_a{b.position_world_m, b.velocity_world_mps, 0.25, 2};
    const core::OtherAgent of_b{a.position_world_m, a.velocity_world_mps, 0.25, 1};
    a.velocity_world_mps = force.velocity(a, {&of_a, 1}, 0, 1.0, {});
    b.velocity_world_mps = force.velocity(b, {&of_b, 1}, 0, 1.0, {});
    a.position_world_m += 0.1 * a.velocity_world_mps;
    b.position_world_m += 0.1 * b.velocity_world_mps;
    closest_m = std::min(closest_m, (a.position_world_m - b.position_world_m).norm());
  }
  EXPECT_GT(closest_m, 0.5);
  EXPECT_GT(a.position_world_m.x(), 2.0);
  EXPECT_LT(b.position_world_m.x(), -2.0);
}

TEST(SocialForce, WhoDoesNotMindVehiclesWalksOnAsIfThereWereNone) {
  SocialForce force;
  core::EgoAgent person;
  person.goal_world_m = {5.0, 0.0};
  person.preferred_speed_mps = 1.0;
  const core::OtherAgent robot{{0.8, 0.1}, {0.0, 0.0}, 0.25, -1};
  const Vector2d alone = force.velocity(person, {}, 0, 1.0, {});
  EXPECT_EQ(force.velocity(person, {&robot, 1}, 1, 0.0, {}), alone);
  EXPECT_LT(force.velocity(person, {&robot, 1}, 1, 1.0, {}).x(), alone.x() - 0.01);
}

// With the lag of a person's velocity behind its wish, as Crowd walks it.
TEST(SocialForce, WhoHardlyMindsVehiclesStopsBeforeOneThatStands) {
  for (const double beside_m : {0.0, 0.05, 0.2, 0.4}) {
    for (const double speed_mps : {0.6, 1.0, 1.4}) {
      SocialForce force;
      core::EgoAgent person;
      person.position_world_m = {-3.0, beside_m};
      person.goal_world_m = {5.0, 0.0};
      person.preferred_speed_mps = speed_mps;
      person.radius_m = 0.25;
      const core::OtherAgent robot{{0.0, 0.0}, {0.0, 0.0}, 0.25, -1};
      Vector2d wanted_mps = Vector2d::Zero();
      double closest_m = 10.0;
      for (int step = 0; step < 2000; ++step) {
        if (step % 20 == 0) {
          wanted_mps = force.velocity(person, {&robot, 1}, 1, 0.3, {});
        }
        person.velocity_world_mps += (1.0 - std::exp(-kStepS / SocialForce::kReactionS)) *
                                     (wanted_mps - person.velocity_world_mps);
        person.position_world_m += kStepS * person.velocity_world_mps;
        closest_m = std::min(closest_m, person.position_world_m.norm());
      }
      EXPECT_GT(closest_m, 0.5) << beside_m << " m beside, " << speed_mps << " m/s";
    }
  }
}

// ---- recorded people

class RecordingTest : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const std::string path = (scratch_.path() / "obsmat.txt").string();
    std::ofstream(path) << text;
    return path;
  }
  std::string errorOf(const std::string& text) {
    try {
      const RecordedPeople people({.file = write(text)}, "test.yaml");
    } catch (const core::StartupError& error) {
      return error.what();
    }
    return "no error";
  }

  test::ScratchFolder scratch_;
  std::vector<Pedestrian> people_;
};

TEST_F(RecordingTest, PeoplePassTheirPlacesAndNobodyComesOutOfNothing) {
  const RecordedPeople recorded({.file = write("780 1 0 0 5 0 0 0\n786 1 0.5 0 5 0 0 0\n"
                                               "792 1 1.0 0 5 0 0 0\n930 2 9 0 9 0 0 0\n"
                                               "936 2 9 0 9 0 0 0\n")},
                                "test.yaml");
  EXPECT_NEAR(recorded.durationS(), 156.0 / 15.0, 1e-12);
  const auto placeAt = [&](double seconds) {
    recorded.at(seconds, people_);
    return people_.empty() ? Vector2d(-99.0, -99.0) : people_[0].position_m;
  };
  EXPECT_EQ(placeAt(0.0), Vector2d(0.0, 5.0));
  EXPECT_LT((placeAt(0.6) - Vector2d(0.75, 5.0)).norm(), 1e-12);
  EXPECT_LT((people_[0].velocity_mps - Vector2d(1.25, 0.0)).norm(), 1e-12);
  EXPECT_LT((placeAt(-2.0) - Vector2d(-2.5, 5.0)).norm(), 1e-12) << "on its way there";
  EXPECT_LT((placeAt(2.8) - Vector2d(3.5, 5.0)).norm(), 1e-12) << "and on from there";
  recorded.at(-5.1, people_);
  EXPECT_TRUE(people_.empty());
  recorded.at(7.0, people_);
  ASSERT_EQ(people_.size(), 1u);
  EXPECT_EQ(people_[0].id, 2);
  EXPECT_EQ(people_[0].position_m, Vector2d(9.0, 9.0));
  recorded.at(20.0, people_);
  EXPECT_TRUE(people_.empty());
}

// The first walks up to the robot. The track of the second begins half a metre beside it.
TEST_F(RecordingTest, NobodyComesOutOfNothingBesideAVehicle) {
  config::Experiment experiment = room(0);
  experiment.pedestrians.recording.file =
      write("0 1 -4 0 0 0 0 0\n60 1 -8 0 0 0 0 0\n105 2 -8 0 1.5 0 0 0\n135 2 -8 0 1.9 0 0 0\n");
  World world(experiment, kBegin);
  const Vector2d robot_m(-8.0, 0.0);
  std::map<std::int32_t, double> appeared_m;
  std::map<std::int32_t, double> nearest_m;
  for (int i = 0; i < std::lround(8.0 / kStepS); ++i) {
    world.step();
    for (const Pedestrian& person : world.people()) {
      const double distance_m = (person.position_m - robot_m).norm();
      appeared_m.try_emplace(person.id, distance_m);
      nearest_m.try_emplace(person.id, distance_m);
      nearest_m[person.id] = std::min(nearest_m[person.id], distance_m);
    }
  }
  ASSERT_EQ(appeared_m.size(), 2u);
  for (const auto& [id, distance_m] : appeared_m) {
    EXPECT_GE(distance_m, experiment.pedestrians.clear_of_vehicles_m) << id;
  }
  EXPECT_LT(nearest_m[Crowd::kRecordedIds + 1], 0.1) << "who is there may come near";
}

TEST_F(RecordingTest, VelocityIsTheDerivativeOfThePlace) {
  const RecordedPeople recorded(
      {.file = write("0 1 0 0 0 0 0 0\n6 1 0.5 0 0.1 0 0 0\n12 1 0.9 0 0.5 0 0 0\n"
                     "24 1 1.2 0 1.5 0 0 0\n")},
      "test.yaml");
  constexpr double kSmall = 1e-6;
  for (double t = 0.05; t < 1.55; t += 0.1) {
    std::vector<Pedestrian> later;
    recorded.at(t, people_);
    recorded.at(t + kSmall, later);
    const Vector2d slope = (later[0].position_m - people_[0].position_m) / kSmall;
    EXPECT_LT((slope - people_[0].velocity_mps).norm(), 1e-4) << t;
  }
}

TEST_F(RecordingTest, WhatIsNoRecordingIsRefusedWithItsLine) {
  EXPECT_THAT(errorOf("780 1 0 0 5 0 0 0\n786 1 0.5 0\n"), HasSubstr("obsmat.txt:2"));
  EXPECT_THAT(errorOf("780 1 nan 0 5 0 0 0\n"), HasSubstr("eight finite numbers"));
  EXPECT_THAT(errorOf("780 1 0 0 5 0 0 0 9\n"), HasSubstr("eight finite numbers"));
  EXPECT_THAT(errorOf(""), HasSubstr("at least one line"));
  EXPECT_THAT(errorOf("1 1 0 0 5 0 0 0\n1 1 0 0 5 0 0 0\n"), HasSubstr("a person once"));
  try {
    const RecordedPeople people({.file = "/nowhere/obsmat.txt"}, "test.yaml");
    FAIL();
  } catch (const core::StartupError& error) {
    EXPECT_THAT(error.what(), HasSubstr("test.yaml: pedestrians.recording.file"));
  }
}

TEST_F(RecordingTest, ReadsTheCrowdOfEth) {
  const auto path = test::referenceFolder() / "pedestrians/eth_seq_eth_obsmat.txt";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "no recorded people at " << path;
  }
  const RecordedPeople recorded({.file = path.string()}, "test.yaml");
  EXPECT_NEAR(recorded.durationS(), (12381.0 - 780.0) / 15.0, 1e-6);
  double fastest_mps = 0.0;
  std::size_t most = 0;
  for (double t = 0.0; t < recorded.durationS(); t += 0.5) {
    recorded.at(t, people_);
    most = std::max(most, people_.size());
    for (const Pedestrian& person : people_) {
      fastest_mps = std::max(fastest_mps, person.velocity_mps.norm());
    }
  }
  EXPECT_GE(most, 27u);  // lines of a frame, and who is on the way there
  EXPECT_LT(most, 60u);
  EXPECT_LT(fastest_mps, 5.0);
}

// ---- who ran into whom

TEST(Encounters, TellWhoRanIntoWhom) {
  Encounters encounters({0.25}, 0.25);
  std::vector<BodyState> robot(1);
  std::vector<Pedestrian> person(1);
  person[0].id = 7;
  const auto meet = [&](double robot_mps, double person_mps, core::Utime now) {
    person[0].position_m = {5.0, 0.0};
    encounters.update(now, robot, person);
    robot[0].velocity_world_mps.x() = robot_mps;
    person[0].velocity_mps.x() = person_mps;
    person[0].position_m = {0.45, 0.0};
    encounters.update(now + 1, robot, person);
    encounters.update(now + 2, robot, person);
    return encounters.all().back().byVehicle();
  };
  EXPECT_TRUE(meet(0.5, 0.0, 10));
  EXPECT_FALSE(meet(0.0, -1.0, 20)) << "it stood";
  EXPECT_FALSE(meet(-0.5, -1.0, 30)) << "it gave way";
  EXPECT_EQ(encounters.all().size(), 3u) << "one for each meeting, however long";
  EXPECT_NEAR(encounters.closestM(), -0.05, 1e-12);
}

}  // namespace
}  // namespace roundabout::sim
