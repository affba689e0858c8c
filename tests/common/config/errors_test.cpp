// Every way in which an experiment file can be wrong, with the one line that says so.

#include <fstream>

#include <gtest/gtest.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"

namespace roundabout::config {
namespace {

std::string errorOf(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  try {
    parseExperiment(yaml, "lab.yaml", overrides);
  } catch (const core::StartupError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "no error";
}

/// Keys in a file whose first line is a valid vehicle, so that `yaml` begins on line 2.
std::string errorBelow(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return errorOf("vehicles: [{name: hex1}, {name: hex2}]\n" + yaml, overrides);
}

// ---- the file

TEST(ConfigError, MissingFile) {
  try {
    readExperiment("/nowhere/lab.yaml");
    FAIL();
  } catch (const core::StartupError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/lab.yaml: experiment: expected a file that can be read, found "
                 "No such file or directory");
  }
}

TEST(ConfigError, AFolderInsteadOfAFile) {
  try {
    readExperiment("/tmp");
    FAIL();
  } catch (const core::StartupError& error) {
    EXPECT_STREQ(error.what(),
                 "/tmp: experiment: expected a file that can be read, found a folder");
  }
}

TEST(ConfigError, NotYaml) {
  EXPECT_EQ(
      errorOf("name: lab\nvehicles: [{name: hex1}\nseed: 1\n"),
      "lab.yaml:3: file: expected YAML, found a syntax error (end of sequence flow not found)");
}

TEST(ConfigError, EmptyFile) {
  EXPECT_EQ(errorOf(""), "lab.yaml:1: file: expected a map of keys, found nothing");
}

TEST(ConfigError, AListInsteadOfAMap) {
  EXPECT_EQ(errorOf("- a\n- b\n"), "lab.yaml:1: file: expected a map of keys, found a list of 2");
}

TEST(ConfigError, TwoDocuments) {
  EXPECT_EQ(errorOf("vehicles: [{name: hex1}]\n---\nseed: 1\n"),
            "lab.yaml:3: file: expected one YAML document, found 2");
}

TEST(ConfigError, SameKeyTwice) {
  EXPECT_EQ(errorBelow("seed: 1\nname: lab\nseed: 2\n"),
            "lab.yaml:4: seed: expected a key once, found it twice");
}

TEST(ConfigError, SameKeyTwiceDeepInside) {
  EXPECT_EQ(errorBelow("sim:\n  mocap:\n    rate_hz: 100\n    rate_hz: 200\n"),
            "lab.yaml:5: sim.mocap.rate_hz: expected a key once, found it twice");
}

TEST(ConfigError, KeyThatIsNotText) {
  EXPECT_EQ(errorBelow("sim: {[a, b]: 1}\n"),
            "lab.yaml:2: sim: expected text as a key, found a list of 2");
}

// ---- depth cameras and clutter

TEST(ConfigError, DepthPicturesThatAreNoDatagram) {
  EXPECT_EQ(
      errorOf("vehicles:\n  - name: rover\n    model: ground_robot\n    height_m: 0.3\n"
              "    lidar: {}\n    cameras:\n      - {depth: {}}\nplanner: {others: tracks}\n"),
      "lab.yaml:7: vehicles[0].cameras[0].width: expected a depth picture of at most 60000 "
      "bytes, two a pixel (160 x 120), found 320 x 240");
}

TEST(ConfigError, DepthsThatEndBeforeTheyBegin) {
  EXPECT_EQ(
      errorOf(
          "vehicles:\n  - name: rover\n    model: ground_robot\n    height_m: 0.3\n"
          "    lidar: {}\n    cameras:\n      - {width: 160, height: 120, depth: {nearest_m: 5}}\n"
          "planner: {others: tracks}\n"),
      "lab.yaml:7: vehicles[0].cameras[0].depth.farthest_m: expected at least nearest_m (5), "
      "found 4");
}

TEST(ConfigError, DepthsThatCannotBeDrivenBy) {
  const auto withCamera = [](const std::string& vehicle, const std::string& more) {
    return errorOf("vehicles:\n  - name: rover\n" + vehicle +
                   "    cameras:\n      - {width: 160, height: 120, depth: {}}\n" + more);
  };
  EXPECT_EQ(withCamera("", ""),
            "lab.yaml:4: vehicles[0].cameras[0].depth: expected a vehicle that drives: the lens's "
            "height is taken as it is, found multirotor");
  const std::string drives = "    model: ground_robot\n    preferred_speed_mps: 1.2\n";
  const std::string looks = "planner: {others: tracks}\n";
  EXPECT_EQ(withCamera(drives, looks),
            "lab.yaml:6: vehicles[0].cameras[0].depth: expected a vehicle with a lidar, so that it "
            "has a perception process, found none");
  EXPECT_EQ(withCamera(drives + "    lidar: {}\n", ""),
            "lab.yaml:7: vehicles[0].cameras[0].depth: expected planner.others: tracks or both, so "
            "that perception is listened to, found states");
  EXPECT_EQ(withCamera(drives + "    lidar: {}\n", looks),
            "lab.yaml:1: perception.depth_highest_m: expected at least vehicles[].height_m (1) of "
            "rover, found 0.8");
  EXPECT_EQ(withCamera(drives + "    lidar: {}\n    height_m: 0.3\n",
                       looks + "perception: {map_rate_hz: 1}\n"),
            "lab.yaml:8: vehicles[0].cameras[0].depth.farthest_m: expected at least 5.81: how far "
            "rover comes until it stops for what is in a picture, or for want of one (rate_hz, "
            "perception.image_period_s, image_delay_s, map_rate_hz, map_publish_hz, "
            "safety.tracks_hold_s), found 4");
}

TEST(ConfigError, ANetworkWithoutItsFile) {
  EXPECT_EQ(errorBelow("perception: {network: {person_class: 3}}\n"),
            "lab.yaml:2: perception.network: expected none, or a perception.detector that is the "
            "path of a network, found \"hog\"");
}

TEST(ConfigError, ClutterThatIsUpsideDown) {
  EXPECT_EQ(errorBelow("sim:\n  clutter:\n"
                       "    - {name: box, points_m: [[0, 0], [1, 0], [1, 1]], bottom_m: 0.3}\n"),
            "lab.yaml:4: sim.clutter[0].top_m: expected more than bottom_m (0.3), found 0.2");
}

// ---- unknown keys

TEST(ConfigError, UnknownKeyAtTheTop) {
  EXPECT_EQ(
      errorBelow("misson: [land]\n"),
      "lab.yaml:2: misson: expected one of name, seed, source, lcm_url, room, "
      "obstacles, no_fly_zones, vehicle_defaults, vehicles, planner, shield, safety, fleet, sim, "
      "pedestrians, mocap, perception, glyphs, mission, found "
      "\"misson\" (did you mean \"mission\"?)");
}

TEST(ConfigError, UnknownKeyOfAVehicle) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n  - name: hex2\n    radus_m: 0.5\n"),
            "lab.yaml:4: vehicles[1].radus_m: expected one of name, model, assumed_radius_m, "
            "body_radius_m, preferred_speed_mps, top_speed_mps, height_m, max_acceleration_mps2, "
            "shielded, start, lidar, cameras, localised_by, found \"radus_m\" (did you mean "
            "\"assumed_radius_m\"?)");
}

TEST(ConfigError, UnknownKeyOfTheVehicleDefaults) {
  EXPECT_EQ(errorBelow("vehicle_defaults:\n  height: 1\n"),
            "lab.yaml:3: vehicle_defaults.height: expected one of name, model, assumed_radius_m, "
            "body_radius_m, preferred_speed_mps, top_speed_mps, height_m, max_acceleration_mps2, "
            "shielded, start, lidar, cameras, localised_by, found \"height\" (did you mean "
            "\"height_m\"?)");
}

TEST(ConfigError, UnknownKeyLikeNoOther) {
  EXPECT_EQ(errorBelow("room: {colour: red}\n"),
            "lab.yaml:2: room.colour: expected one of min_m, max_m, found \"colour\"");
}

TEST(ConfigError, UnknownKeyWithDotsIsShownWhereItStands) {
  EXPECT_EQ(errorBelow("sim:\n  pacing: lockstep\nsim.pacing: real_time\n").substr(0, 25),
            "lab.yaml:4: sim.pacing: e");
}

TEST(ConfigError, UnknownKeyOfSeveralLinesTakesOne) {
  EXPECT_EQ(errorBelow("room: {\"a\\nb\": 1}\n"),
            "lab.yaml:2: room.a b: expected one of min_m, max_m, found \"a b\"");
}

// ---- types

TEST(ConfigError, TextInsteadOfANumber) {
  EXPECT_EQ(errorOf("vehicles:\n- name: a\n- name: b\n- name: c\n  preferred_speed_mps: fast\n"),
            "lab.yaml:5: vehicles[2].preferred_speed_mps: expected a number above 0, found "
            "\"fast\"");
}

TEST(ConfigError, NumberWithAUnit) {
  EXPECT_EQ(errorBelow("planner: {rate_hz: 10 Hz}\n"),
            "lab.yaml:2: planner.rate_hz: expected a number above 0, found \"10 Hz\"");
}

TEST(ConfigError, QuotedNumber) {
  EXPECT_EQ(errorBelow("planner: {rate_hz: '10'}\n"),
            "lab.yaml:2: planner.rate_hz: expected a number above 0, found the text \"10\"");
}

TEST(ConfigError, ListInsteadOfANumber) {
  EXPECT_EQ(errorBelow("planner: {rate_hz: [10]}\n"),
            "lab.yaml:2: planner.rate_hz: expected a number above 0, found a list of 1");
}

TEST(ConfigError, NothingInsteadOfANumber) {
  EXPECT_EQ(errorBelow("planner:\n  rate_hz:\n"),
            "lab.yaml:3: planner.rate_hz: expected a number above 0, found nothing");
}

TEST(ConfigError, FractionInsteadOfAWholeNumber) {
  EXPECT_EQ(errorBelow("safety: {max_rejects_in_a_row: 2.5}\n"),
            "lab.yaml:2: safety.max_rejects_in_a_row: expected a whole number of at least 1, "
            "found 2.5");
}

TEST(ConfigError, NegativeSeed) {
  EXPECT_EQ(errorBelow("seed: -1\n"),
            "lab.yaml:2: seed: expected a whole number of at least 0, found -1");
}

TEST(ConfigError, SeedOfMoreThan64Bits) {
  EXPECT_EQ(errorBelow("seed: 18446744073709551616\n"),
            "lab.yaml:2: seed: expected a whole number of at least 0, found 18446744073709551616");
}

TEST(ConfigError, YesInsteadOfTrue) {
  EXPECT_EQ(errorBelow("planner: {watch_wall_clock: yes}\n"),
            "lab.yaml:2: planner.watch_wall_clock: expected true or false, found \"yes\"");
}

TEST(ConfigError, MapInsteadOfText) {
  EXPECT_EQ(errorBelow("planner: {policy: {name: orca}}\n"),
            "lab.yaml:2: planner.policy: expected text, found a map");
}

TEST(ConfigError, TextInsteadOfAMap) {
  EXPECT_EQ(errorBelow("sim: fast\n"), "lab.yaml:2: sim: expected a map of keys, found \"fast\"");
}

TEST(ConfigError, MapInsteadOfAList) {
  EXPECT_EQ(errorOf("vehicles:\n  hex1: {}\n"),
            "lab.yaml:1: vehicles: expected a list, found a map");
}

TEST(ConfigError, PointOfWrongSize) {
  EXPECT_EQ(errorBelow("room: {min_m: [0, 0]}\n"),
            "lab.yaml:2: room.min_m: expected [x, y, z], found a list of 2");
}

TEST(ConfigError, CoordinateThatIsNoNumber) {
  EXPECT_EQ(errorBelow("room: {min_m: [0, left, 0]}\n"),
            "lab.yaml:2: room.min_m[1]: expected a number, found \"left\"");
}

// ---- ranges

TEST(ConfigError, NegativeRadius) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n    body_radius_m: -0.35\n"),
            "lab.yaml:3: vehicles[0].body_radius_m: expected a number above 0, found -0.35");
}

TEST(ConfigError, RateZero) {
  EXPECT_EQ(errorBelow("fleet: {rate_hz: 0}\n"),
            "lab.yaml:2: fleet.rate_hz: expected a number above 0, found 0");
}

TEST(ConfigError, NumbersThatAreNotFinite) {
  for (const char* text : {".nan", "nan", ".inf", "inf", "-.inf", "1e999"}) {
    EXPECT_EQ(errorBelow(std::string("fleet: {letter_centre_m: [0, ") + text + "]}\n"),
              std::string("lab.yaml:2: fleet.letter_centre_m[1]: expected a number, found \"") +
                  text + "\"");
  }
}

TEST(ConfigError, RateOutsideARange) {
  EXPECT_EQ(errorBelow("sim: {mocap: {rate_hz: 5000}}\n"),
            "lab.yaml:2: sim.mocap.rate_hz: expected a number from 5 to 1000, found 5000");
}

TEST(ConfigError, UnknownPacing) {
  EXPECT_EQ(errorBelow("sim: {pacing: fast}\n"),
            "lab.yaml:2: sim.pacing: expected lockstep or real_time, found \"fast\"");
}

TEST(ConfigError, UnknownAssignment) {
  EXPECT_EQ(errorBelow("fleet: {assignment: best}\n"),
            "lab.yaml:2: fleet.assignment: expected random or optimal or in_order, found \"best\"");
}

TEST(ConfigError, NameThatDoesNotFitAChannel) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex-1\n"),
            "lab.yaml:2: vehicles[0].name: expected letters, digits and underscore, found "
            "\"hex-1\"");
}

// ---- keys that contradict each other

TEST(ConfigError, NoVehicles) {
  EXPECT_EQ(errorOf("seed: 1\nvehicles: []\n"),
            "lab.yaml:2: vehicles: expected at least one vehicle, found none");
}

TEST(ConfigError, VehicleWithoutAName) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n  - height_m: 1\n"),
            "lab.yaml:3: vehicles[1].name: expected letters, digits and underscore, found nothing");
}

TEST(ConfigError, TwoVehiclesOfOneName) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n  - name: hex2\n  - name: hex1\n"),
            "lab.yaml:4: vehicles[2].name: expected a name of its own, found \"hex1\", which is "
            "vehicles[0]'s");
}

TEST(ConfigError, StartsFromWhichTwoTakeOffThroughEachOthersSpace) {
  // 1 m: bodies of 0.35 m do not touch, but a goal there would be refused.
  EXPECT_EQ(errorOf("vehicles:\n"
                    "  - {name: hex1, start: {position_m: [0, 0]}}\n"
                    "  - {name: hex2, start: {position_m: [0.6, 0.8]}}\n"),
            "lab.yaml:3: vehicles[1].start.position_m: expected at least 1.1 m (two assumed radii "
            "and safety.goal_margin_m) from vehicles[0] \"hex1\", found 1.000 m");
}

TEST(ConfigError, RandomStartsFromWhichTwoTakeOffThroughEachOthersSpace) {
  EXPECT_EQ(errorBelow("sim: {start_spacing_m: 0.3}\n"),
            "lab.yaml:2: sim.start_spacing_m: expected at least 1.1 (two assumed radii and "
            "safety.goal_margin_m), found 0.3");
}

TEST(ConfigError, RandomStartsDoNotMatterWhereEverybodyHasAPlace) {
  EXPECT_EQ(errorOf("vehicles: [{name: hex1, start: {position_m: [0, 0]}}]\n"
                    "room: {min_m: [-1, -1, 0], max_m: [1, 1, 3]}\n"
                    "sim: {start_spacing_m: 0.3}\n"),
            "no error");
}

TEST(ConfigError, BodyLargerThanWhatPoliciesSee) {
  EXPECT_EQ(errorOf("vehicles:\n  - {name: hex1, assumed_radius_m: 0.3}\n"),
            "lab.yaml:2: vehicles[0].assumed_radius_m: expected at least body_radius_m (0.35), "
            "found 0.3");
}

TEST(ConfigError, FloorThatIsNotWhereZIsZero) {
  EXPECT_EQ(errorBelow("room: {min_m: [-10, -10, 0.5]}\n"),
            "lab.yaml:2: room.min_m: expected z = 0, since the floor is where z is 0, found z = "
            "0.5");
}

TEST(ConfigError, SourceThatNobodyImplements) {
  EXPECT_EQ(errorBelow("source: simm\n"),
            "lab.yaml:2: source: expected sim or natnet or qualisys or vrpn or vicon_udp or "
            "replay, found \"simm\"");
}

TEST(ConfigError, StepTooShortToCount) {
  EXPECT_EQ(errorBelow("sim: {step_s: 1e-7}\n"),
            "lab.yaml:2: sim.step_s: expected a number from 0.0001 to 1, found 1e-7");
}

TEST(ConfigError, LatencyLongerThanAnyCameras) {
  EXPECT_EQ(errorBelow("sim: {mocap: {latency_s: 1e9}}\n"),
            "lab.yaml:2: sim.mocap.latency_s: expected a number from 0 to 1, found 1e9");
}

TEST(ConfigError, StartOutsideTheRoom) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n    start:\n      position_m: [0, 11]\n"),
            "lab.yaml:4: vehicles[0].start.position_m: expected a place in the room (x -10 to 10, "
            "y -10 to 10) less a body radius of 0.35 m, found [0, 11]");
}

TEST(ConfigError, StartWhereTheBodyReachesIntoTheWall) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n    start:\n      position_m: [0, 9.7]\n"),
            "lab.yaml:4: vehicles[0].start.position_m: expected a place in the room (x -10 to 10, "
            "y -10 to 10) less a body radius of 0.35 m, found [0, 9.7]");
}

TEST(ConfigError, HeightAboveTheRoom) {
  EXPECT_EQ(errorOf("vehicles:\n  - name: hex1\n    height_m: 4.5\n"),
            "lab.yaml:3: vehicles[0].height_m: expected a height in the room (0 to 4), found 4.5");
}

TEST(ConfigError, HeightFromTheDefaultsPointsAtTheVehicle) {
  EXPECT_EQ(errorOf("vehicle_defaults: {height_m: 4.5}\nvehicles:\n  - name: hex1\n"),
            "lab.yaml:3: vehicles[0].height_m: expected a height in the room (0 to 4), found 4.5");
}

TEST(ConfigError, PreferredSpeedAboveTopSpeed) {
  EXPECT_EQ(errorOf("vehicles:\n  - {name: hex1, preferred_speed_mps: 1, top_speed_mps: 0.5}\n"),
            "lab.yaml:2: vehicles[0].top_speed_mps: expected at least preferred_speed_mps (1), "
            "found 0.5");
}

TEST(ConfigError, RoomInsideOut) {
  EXPECT_EQ(errorBelow("room: {min_m: [0, 0, 0], max_m: [5, -5, 3]}\n"),
            "lab.yaml:2: room.max_m: expected every coordinate above min_m's, found [5, -5, 3]");
}

TEST(ConfigError, StartAreaOutsideTheRoom) {
  EXPECT_EQ(errorBelow("room: {min_m: [-3, -3, 0], max_m: [3, 3, 3]}\n"
                       "sim:\n  start_area: {min_m: [-2, -2], max_m: [5, 2]}\n"),
            "lab.yaml:4: sim.start_area.max_m: expected a place in the room (x -3 to 3, y -3 to "
            "3) less a body radius of 0.35 m, found [5, 2]");
}

TEST(ConfigError, WhereNothingIsSimulatedNoStartAreaIsAskedFor) {
  EXPECT_EQ(errorBelow("source: natnet\nroom: {min_m: [-3, -3, 0], max_m: [3, 3, 3]}\n"),
            "no error");
}

TEST(ConfigError, LandBeforeHold) {
  EXPECT_EQ(errorBelow("safety: {states_hold_s: 0.3, states_land_s: 0.2}\n"),
            "lab.yaml:2: safety.states_land_s: expected at least states_hold_s (0.3), found 0.2");
  EXPECT_EQ(errorBelow("safety: {own_track_land_s: 0.1}\n"),
            "lab.yaml:2: safety.own_track_land_s: expected at least own_track_hold_s (0.15), found "
            "0.1");
  EXPECT_EQ(errorBelow("sim: {command_land_s: 0.1}\n"),
            "lab.yaml:2: sim.command_land_s: expected at least command_hold_s (0.3), found 0.1");
}

TEST(ConfigError, HoldsFartherThanItSlowsDown) {
  EXPECT_EQ(errorBelow("planner: {slow_down_distance_m: 0.2}\n"),
            "lab.yaml:2: planner.slow_down_distance_m: expected at least hold_distance_m (0.3), "
            "found 0.2");
}

TEST(ConfigError, PlannerFasterThanTheCameras) {
  EXPECT_EQ(errorBelow("sim: {mocap: {rate_hz: 8}, step_s: 0.125}\n"),
            "lab.yaml:2: sim.mocap.rate_hz: expected at least planner.rate_hz (10), found 8");
}

TEST(ConfigError, StepThatDoesNotDivideTheFrame) {
  EXPECT_EQ(errorBelow("sim: {step_s: 0.002}\n"),
            "lab.yaml:2: sim.step_s: expected a whole part of the frame interval (1/200 s), found "
            "0.002");
}

TEST(ConfigError, PushOfAnUnknownVehicle) {
  EXPECT_EQ(errorBelow("sim:\n  pushes:\n    - vehicle: hex3\n"),
            "lab.yaml:4: sim.pushes[0].vehicle: expected a vehicle (hex1, hex2), found \"hex3\"");
}

// ---- missions and glyphs

TEST(ConfigError, UnknownVerb) {
  EXPECT_EQ(errorBelow("mission:\n  - takeoff\n"),
            "lab.yaml:3: mission[0]: expected one of take_off, spell, formation, go_to, hold, "
            "wait, wait_until, land, found \"takeoff\"");
  EXPECT_EQ(errorBelow("mission:\n  - dance: {text: A}\n"),
            "lab.yaml:3: mission[0]: expected one of take_off, spell, formation, go_to, hold, "
            "wait, wait_until, land, found \"dance\"");
}

TEST(ConfigError, TwoVerbsInOneStep) {
  EXPECT_EQ(errorBelow("mission:\n  - {spell: A, wait: 1}\n"),
            "lab.yaml:3: mission[0]: expected a verb, or a map with one verb as its key, found a "
            "map");
}

TEST(ConfigError, ArgumentOfAVerbThatHasNone) {
  EXPECT_EQ(errorBelow("mission:\n  - land: {seconds: 3}\n"),
            "lab.yaml:3: mission[0]: expected no more than the verb land, found a map");
}

TEST(ConfigError, UnknownArgument) {
  EXPECT_EQ(errorBelow("mission:\n  - spell: {txt: A}\n"),
            "lab.yaml:3: mission[0].spell.txt: expected one of text, seconds, found \"txt\" (did "
            "you mean \"text\"?)");
}

TEST(ConfigError, SpellWithoutText) {
  EXPECT_EQ(errorBelow("mission: [spell]\n"),
            "lab.yaml:2: mission[0].spell: expected text to spell, found nothing");
}

TEST(ConfigError, NegativeWait) {
  EXPECT_EQ(errorBelow("mission:\n  - wait: -3\n"),
            "lab.yaml:3: mission[0].wait: expected a number of at least 0, found -3");
}

TEST(ConfigError, WaitWithoutSeconds) {
  EXPECT_EQ(errorBelow("mission: [wait]\n"),
            "lab.yaml:2: mission[0].wait: expected a number of at least 0, found nothing");
}

TEST(ConfigError, WaitUntilSomethingThatNeverIs) {
  for (const auto& [asked, found] : {std::pair{"sunrise", "\"sunrise\""}, std::pair{"-1", "\"-1\""},
                                     std::pair{"{seconds: 3}", "a map"}}) {
    EXPECT_EQ(errorBelow(std::string("mission:\n  - wait_until: ") + asked + "\n"),
              std::string("lab.yaml:3: mission[0].wait_until: expected formed, go_on, or seconds "
                          "since the take-off, found ") +
                  found);
  }
  EXPECT_EQ(errorBelow("mission: [wait_until]\n"),
            "lab.yaml:2: mission[0].wait_until: expected formed, go_on, or seconds since the "
            "take-off, found nothing");
}

TEST(ConfigError, GoToOfAnUnknownVehicle) {
  EXPECT_EQ(errorBelow("mission:\n  - go_to: {vehicle: hex9, point: [0, 0, 1]}\n"),
            "lab.yaml:3: mission[0].go_to.vehicle: expected a vehicle (hex1, hex2), found "
            "\"hex9\"");
}

TEST(ConfigError, GoToWithoutAPoint) {
  EXPECT_EQ(errorBelow("mission:\n  - go_to: {vehicle: hex1}\n"),
            "lab.yaml:3: mission[0].go_to.point: expected [x, y] or [x, y, z], found nothing");
}

TEST(ConfigError, PointOfWrongSizeInAFormation) {
  EXPECT_EQ(errorBelow("mission:\n  - formation:\n      points: [[0, 0], [1]]\n"),
            "lab.yaml:4: mission[0].formation.points[1]: expected [x, y] or [x, y, z], found a "
            "list of 1");
}

TEST(ConfigError, FormationWithMorePointsThanVehicles) {
  EXPECT_EQ(errorBelow("mission:\n  - formation: {points: [[0, 0], [2, 0], [4, 0]]}\n"),
            "lab.yaml:3: mission[0].formation.points: expected 1 to 2 points (one a vehicle at "
            "most), found 3");
}

TEST(ConfigError, FormationWithoutPoints) {
  EXPECT_EQ(errorBelow("mission:\n  - formation: {name: swap}\n"),
            "lab.yaml:3: mission[0].formation.points: expected 1 to 2 points (one a vehicle at "
            "most), found 0");
}

TEST(ConfigError, GlyphWithMorePointsThanVehicles) {
  EXPECT_EQ(errorBelow("glyphs:\n  - {name: I, points_m: [[0, 0], [2, 0], [4, 0]]}\n"),
            "lab.yaml:3: glyphs[0].points_m: expected 1 to 2 points (one a vehicle at most), found "
            "3");
}

TEST(ConfigError, GlyphOfTwoCharacters) {
  EXPECT_EQ(errorBelow("glyphs:\n  - {name: AB, points_m: [[0, 0]]}\n"),
            "lab.yaml:3: glyphs[0].name: expected one character, found \"AB\"");
}

TEST(ConfigError, TwoGlyphsOfOneCharacter) {
  EXPECT_EQ(errorBelow("glyphs:\n  - {name: I, points_m: [[0, 0]]}\n"
                       "  - {name: I, points_m: [[1, 0]]}\n"),
            "lab.yaml:4: glyphs[1].name: expected a name of its own, found \"I\", which is "
            "glyphs[0]'s");
}

TEST(ConfigError, PointWithoutHeightAmongVehiclesOfDifferentHeights) {
  EXPECT_EQ(errorOf("vehicles: [{name: hex1, height_m: 1}, {name: hex2, height_m: 2}]\n"
                    "mission:\n  - formation: {points: [[3, 4]]}\n"),
            "lab.yaml:3: mission[0].formation.points[0]: expected [x, y, z], since heights of "
            "flight differ, found [3, 4]");
}

// ---- obstacles

std::string obstacleError(const std::string& list) {
  return errorBelow("obstacles: " + list + "\n");
}

TEST(ConfigError, ObstacleWithoutAName) {
  EXPECT_EQ(
      obstacleError("[{points_m: [[3, 3], [4, 3], [3, 4]]}]"),
      "lab.yaml:2: obstacles[0].name: expected letters, digits and underscore, found nothing");
}

TEST(ConfigError, TwoObstaclesOfOneName) {
  EXPECT_EQ(obstacleError("[{name: a, points_m: [[3, 3], [4, 3], [3, 4]]}, "
                          "{name: a, points_m: [[5, 5], [6, 5], [5, 6]]}]"),
            "lab.yaml:2: obstacles[1].name: expected a name of its own, found \"a\", which is "
            "obstacles[0]'s");
}

TEST(ConfigError, ANoFlyZoneIsCheckedAsAnObstacleIs) {
  EXPECT_EQ(errorBelow("no_fly_zones: [{name: stage, points_m: [[0, 0], [1, 0]]}]\n"),
            "lab.yaml:2: no_fly_zones[0].points_m: expected at least 3 corners, found 2");
}

TEST(ConfigError, CommandsMustOutliveTheirDelay) {
  EXPECT_EQ(errorOf("vehicles: [{name: hex1}]\nplanner: {command_valid_s: 0.15}\n"),
            "lab.yaml:2: planner.command_valid_s: expected at least 0.2 (shield.multirotor.delay_s "
            "and a planning period), found 0.15");
}

TEST(ConfigError, AShieldsBoundsAreBounds) {
  EXPECT_EQ(errorBelow("shield: {multirotor: {lag_s: -0.1}}\n"),
            "lab.yaml:2: shield.multirotor.lag_s: expected a number from 0 to 2, found -0.1");
}

TEST(ConfigError, ObstacleOfTwoCorners) {
  EXPECT_EQ(obstacleError("[{name: a, points_m: [[3, 3], [4, 3]]}]"),
            "lab.yaml:2: obstacles[0].points_m: expected at least 3 corners, found 2");
}

TEST(ConfigError, ObstacleWhoseSidesCrossOrTouch) {
  const std::string error =
      "lab.yaml:2: obstacles[0].points_m: expected the corners of a polygon, in their order along "
      "its outline, found sides that touch or cross each other";
  for (const char* points :
       {"[[3, 3], [5, 5], [5, 3], [3, 5]]", "[[3, 3], [4, 3], [5, 3]]",
        "[[3, 3], [5, 3], [5, 5], [4, 3], [3, 5]]", "[[3, 3], [3, 3], [5, 3], [5, 5]]"}) {
    EXPECT_EQ(obstacleError(std::string("[{name: a, points_m: ") + points + "}]"), error) << points;
  }
}

TEST(ConfigError, ObstacleOutsideTheRoom) {
  EXPECT_EQ(
      obstacleError("[{name: a, points_m: [[3, 3], [11, 3], [3, 4]]}]"),
      "lab.yaml:2: obstacles[0].points_m[1]: expected a place in the room (x -10 to 10, y -10 "
      "to 10), found [11, 3]");
}

TEST(ConfigError, StartTooCloseToAnObstacle) {
  const auto error = [](const std::string& start) {
    return errorOf("vehicles: [{name: hex1, start: {position_m: " + start + "}}]\n" +
                   "obstacles: [{name: box, points_m: [[3, 3], [5, 3], [5, 5], [3, 5]]}]\n");
  };
  EXPECT_EQ(error("[2.4, 4]"), "no error");
  EXPECT_EQ(error("[2.5, 4]"),
            "lab.yaml:1: vehicles[0].start.position_m: expected at least 0.6 m (an assumed radius "
            "and safety.goal_margin_m) from obstacle \"box\", found 0.500 m");
  EXPECT_EQ(error("[4, 4]"),
            "lab.yaml:1: vehicles[0].start.position_m: expected at least 0.6 m (an assumed radius "
            "and safety.goal_margin_m) from obstacle \"box\", found a place inside it");
}

TEST(ConfigError, ObstacleHorizonShorterThanAStep) {
  EXPECT_EQ(
      errorBelow("planner: {orca: {obstacle_horizon_s: 0.05}}\n"),
      "lab.yaml:2: planner.orca.obstacle_horizon_s: expected at least time_step_s (0.1), found "
      "0.05");
}

// ---- overrides

TEST(ConfigError, OverrideWithoutEquals) {
  EXPECT_EQ(errorBelow("", {"sim.pacing"}),
            "--set: argument: expected KEY=VALUE, found \"sim.pacing\"");
}

TEST(ConfigError, OverrideOfAnUnknownKey) {
  EXPECT_EQ(errorBelow("", {"room.top_m=3"}),
            "--set room.top_m: room.top_m: expected one of min_m, max_m, found \"top_m\"");
}

TEST(ConfigError, OverrideBelowAnUnknownKey) {
  EXPECT_EQ(errorBelow("", {"simm.pacing=lockstep"}).substr(0, 24), "--set simm.pacing: simm:");
}

TEST(ConfigError, OverrideOfWrongType) {
  EXPECT_EQ(errorBelow("planner: {rate_hz: 10}\n", {"planner.rate_hz=fast"}),
            "--set planner.rate_hz: planner.rate_hz: expected a number above 0, found \"fast\"");
}

TEST(ConfigError, OverrideWithTheSameKeyTwice) {
  EXPECT_EQ(errorBelow("", {"room={min_m: [0, 0, 0], min_m: [1, 1, 1]}"}),
            "--set room: room.min_m: expected a key once, found it twice");
}

TEST(ConfigError, OverrideThatContradictsTheFile) {
  EXPECT_EQ(errorBelow("", {"vehicles.1.name=hex1"}),
            "--set vehicles.1.name: vehicles[1].name: expected a name of its own, found \"hex1\", "
            "which is vehicles[0]'s");
}

TEST(ConfigError, OverrideOfAVehicleThatIsNotThere) {
  EXPECT_EQ(errorBelow("", {"vehicles.2.name=hex3"}),
            "--set vehicles.2.name: index: expected a number below 2 (it is a list), found \"2\"");
}

TEST(ConfigError, OverrideOfAKeyInAList) {
  EXPECT_EQ(errorBelow("", {"vehicles.name=hex3"}),
            "--set vehicles.name: index: expected a number below 2 (it is a list), found \"name\"");
}

TEST(ConfigError, OverrideBelowAValue) {
  EXPECT_EQ(errorBelow("seed: 1\n", {"seed.value=2"}),
            "--set seed.value: key: expected a path through maps and lists, found \"value\" below "
            "the value \"1\"");
}

TEST(ConfigError, OverrideThatIsNotYaml) {
  EXPECT_EQ(errorBelow("", {"mission=[take_off"}),
            "--set mission: value: expected YAML, found a syntax error (end of sequence flow not "
            "found)");
}

TEST(ConfigError, AnErrorOfTheFileIsNotBlamedOnAnOverride) {
  EXPECT_EQ(errorBelow("sim:\n  pacing: fast\n", {"sim.step_s=0.001"}),
            "lab.yaml:3: sim.pacing: expected lockstep or real_time, found \"fast\"");
}

// ---- motion capture

TEST(ConfigError, OneBodyOfTwoVehicles) {
  EXPECT_EQ(errorBelow("mocap:\n  bodies:\n  - {vehicle: hex1, body: Hex_1}\n"
                       "  - {vehicle: hex2, body: Hex_1}\n"),
            "lab.yaml:5: mocap.bodies[1]: expected a body that is no other vehicle's, found Hex_1, "
            "which is hex1's");
  EXPECT_EQ(errorBelow("mocap:\n  bodies:\n  - {vehicle: hex1, id: 4}\n"
                       "  - {vehicle: hex2, id: 4}\n"),
            "lab.yaml:5: mocap.bodies[1]: expected a body that is no other vehicle's, found id 4, "
            "which is hex1's");
  EXPECT_EQ(errorBelow("mocap:\n  bodies:\n  - {vehicle: hex1, body: hex2}\n"),
            "lab.yaml:4: mocap.bodies[0]: expected a body that is no other vehicle's, found hex2, "
            "which is hex2's");
  EXPECT_EQ(errorBelow("mocap:\n  bodies:\n  - {vehicle: hex1, body: hex2}\n"
                       "  - {vehicle: hex2, body: hex1}\n"),
            "no error");
}

// ---- nothing that a file holds crashes the reader

TEST(ConfigError, DeepNestingAndCyclesAreErrors) {
  EXPECT_NE(errorOf(std::string(100000, '[')), "no error");
  EXPECT_NE(errorOf("vehicles: &a [*a]\n"), "no error");
  EXPECT_NE(errorOf("vehicles: [{name: hex1}]\nsim: &s {mocap: *s}\n"), "no error");
}

}  // namespace
}  // namespace roundabout::config
