#include <gtest/gtest.h>

#include "common/config/experiment_file.h"
#include "tests/common/config/key_collector.h"
#include "tests/common/config/one_of_everything.h"

namespace roundabout::config {
namespace {

/// Converts to anything: as many of them as initialise an aggregate, so many members it has.
struct Anything {
  template <class Type>
  operator Type() const;  // NOLINT(google-explicit-constructor): that is the point
};

template <class Struct, class... Members>
constexpr std::size_t memberCount() {
  if constexpr (requires { Struct{Members{}..., Anything{}}; }) {
    return memberCount<Struct, Members..., Anything>();
  } else {
    return sizeof...(Members);
  }
}

template <class Struct>
std::size_t keyCount() {
  Struct value{};
  KeyCollector collector;
  describe(collector, value);
  return collector.keysAtTop();
}

TEST(ExperimentKeys, CoverEveryMemberOfEveryStruct) {
  EXPECT_EQ(keyCount<Room>(), memberCount<Room>());
  EXPECT_EQ(keyCount<Start>(), memberCount<Start>());
  EXPECT_EQ(keyCount<Vehicle>(), memberCount<Vehicle>());
  EXPECT_EQ(keyCount<UnicycleModel>(), memberCount<UnicycleModel>());
  EXPECT_EQ(keyCount<MultirotorModel>(), memberCount<MultirotorModel>());
  EXPECT_EQ(keyCount<MocapFault>(), memberCount<MocapFault>());
  EXPECT_EQ(keyCount<MocapModel>(), memberCount<MocapModel>());
  EXPECT_EQ(keyCount<Area>(), memberCount<Area>());
  EXPECT_EQ(keyCount<Push>(), memberCount<Push>());
  EXPECT_EQ(keyCount<Sim>(), memberCount<Sim>());
  EXPECT_EQ(keyCount<MocapBody>(), memberCount<MocapBody>());
  EXPECT_EQ(keyCount<MocapFilter>(), memberCount<MocapFilter>());
  EXPECT_EQ(keyCount<Mocap>(), memberCount<Mocap>());
  EXPECT_EQ(keyCount<Orca>(), memberCount<Orca>());
  EXPECT_EQ(keyCount<Planner>(), memberCount<Planner>());
  EXPECT_EQ(keyCount<Safety>(), memberCount<Safety>());
  EXPECT_EQ(keyCount<Fleet>(), memberCount<Fleet>());
  EXPECT_EQ(keyCount<NamedPoints>(), memberCount<NamedPoints>());
  EXPECT_EQ(keyCount<Experiment>() + 1, memberCount<Experiment>());  // `file` is not a key
}

TEST(ToYaml, OneOfEverythingReadsBackTheSame) {
  const std::string yaml = toYaml(oneOfEverything());
  const Experiment read = parseExperiment(yaml, "everything.yaml");
  EXPECT_EQ(toYaml(read), yaml);
  EXPECT_EQ(read.seed, 18446744073709551615ULL);
  EXPECT_EQ(read.vehicles[0].body_radius_m, 0.1 + 0.2);
  EXPECT_EQ(read.vehicles[0].start->heading_rad, -0.75);
  EXPECT_FALSE(read.vehicles[1].start.has_value());
  EXPECT_EQ(read.vehicles[1].name, "2");
  EXPECT_FALSE(read.planner.watch_wall_clock);
  EXPECT_EQ(read.safety.max_rejects_in_a_row, 12);
  EXPECT_EQ(read.sim.mocap.dropout.duration_s, 0.2);
  EXPECT_EQ(read.sim.pushes[0].acceleration_mps2, Eigen::Vector2d(1.0, -2.0));
  EXPECT_EQ(read.glyphs[0].name, "#");
  ASSERT_EQ(read.mission.size(), 9u);
  EXPECT_EQ(read.mission[1].text, "A B: \"C\"");
  EXPECT_EQ(read.mission[2].points_m[1], Eigen::Vector3d(-1.0, 2.0, 1.0));
  EXPECT_LT(read.mission[2].seconds, 0.0);
  EXPECT_EQ(read.mission[5].seconds, 0.0);
  EXPECT_EQ(read.mission[6].text, "formed");
  EXPECT_EQ(read.mission[7].seconds, 1.5);
}

TEST(ToYaml, OneOfEverythingDiffersFromTheDefaultsInEveryKey) {
  Experiment defaults;
  Experiment everything = oneOfEverything();
  KeyCollector default_keys;
  KeyCollector other_keys;
  describe(default_keys, defaults);
  describe(other_keys, everything);
  for (const auto& [key, value] : default_keys.keys()) {
    if (!value.empty() && key.find("[]") == std::string::npos) {
      EXPECT_NE(other_keys.keys().at(key), value) << key;
    }
  }
}

TEST(ToYaml, DefaultsReadBackTheSame) {
  Experiment defaults;
  defaults.name = "defaults";
  defaults.vehicles.resize(1);
  defaults.vehicles[0].name = "hex1";
  const std::string yaml = toYaml(defaults);
  const Experiment read = parseExperiment(yaml, "defaults.yaml");
  EXPECT_EQ(toYaml(read), yaml);
}

TEST(ToYaml, WordsThatLookLikeOtherThingsStayText) {
  for (const char* text :
       {"null", "~", "true", "12", "1e3", "- a", "a: b", "#", " x ", "\xC3\xA9"}) {
    Experiment experiment = oneOfEverything();
    experiment.mission[1].text = text;
    EXPECT_EQ(parseExperiment(toYaml(experiment), "x.yaml").mission[1].text, text);
  }
}

TEST(ParseExperiment, AFileThatNamesOneVehicleHasTheDefaults) {
  const Experiment read = parseExperiment("vehicles: [{name: hex1}]", "folder/lab.yaml");
  Experiment expected;
  expected.name = "lab";
  expected.vehicles.resize(1);
  expected.vehicles[0].name = "hex1";
  EXPECT_EQ(toYaml(read), toYaml(expected));
  EXPECT_EQ(read.file, "folder/lab.yaml");
}

}  // namespace
}  // namespace roundabout::config
