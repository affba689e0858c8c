// Types read from .lcm text, held against the code that lcm-gen makes of the same files.

#include <limits>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/bus/typed.h"
#include "common/core/error.h"
#include "common/core/random.h"
#include "logs/files.h"
#include "logs/types/json_text.h"
#include "logs/types/type_table.h"
#include "logs/types/walk.h"
#include "roundabout_msgs/log_marker_t.hpp"
#include "tests/common/bus/sample_messages.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using nlohmann::json;
using testing::HasSubstr;

template <class Message>
Message sampleOf() {
  if constexpr (std::is_same_v<Message, roundabout_msgs::log_marker_t>) {
    return {1, "flight begins"};
  } else {
    return bus::sample<Message>();
  }
}

template <class Message>
class OwnTypes : public testing::Test {
 protected:
  const MessageType* type() const {
    return types_.find(static_cast<std::uint64_t>(Message::getHash()));
  }
  TypeTable types_;
};

using Messages = testing::Types<
    roundabout_msgs::vehicle_states_t, roundabout_msgs::goal_t, roundabout_msgs::command_t,
    roundabout_msgs::planner_status_t, roundabout_msgs::fleet_status_t, roundabout_msgs::mission_t,
    roundabout_msgs::safety_order_t, roundabout_msgs::planar_lidar_t,
    roundabout_msgs::agent_tracks_t, roundabout_msgs::image_t, roundabout_msgs::occupancy_t,
    roundabout_msgs::odometry_t, roundabout_msgs::log_marker_t>;
TYPED_TEST_SUITE(OwnTypes, Messages);

TYPED_TEST(OwnTypes, HaveTheFingerprintThatLcmGenComputes) {
  ASSERT_NE(this->type(), nullptr);
  EXPECT_EQ(this->type()->name, TypeParam::getTypeName());
}

TYPED_TEST(OwnTypes, NeverReadBeyondADamagedMessage) {
  std::vector<std::byte> bytes = bus::encode(sampleOf<TypeParam>());
  core::RandomStream random(3, "walk");
  std::string text;
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> damaged = bytes;
    for (int hits = 0; hits < 3; ++hits) {
      damaged[8 + random.index(damaged.size() - 8)] = static_cast<std::byte>(random.index(256));
    }
    damaged.resize(random.index(damaged.size() + 1));
    text.clear();
    TypeParam by_lcm;
    const bool sound = bus::decode(damaged, by_lcm) == nullptr;
    const char* problem = appendJson(*this->type(), damaged, text);
    if (sound) {
      EXPECT_EQ(problem, nullptr);
    }
    if (problem == nullptr) {
      EXPECT_FALSE(json::parse(text, nullptr, false).is_discarded()) << text;
    } else {
      EXPECT_EQ(text, "");
    }
  }
}

class JsonText : public testing::Test {
 protected:
  template <class Message>
  json of(const Message& message) {
    std::string text;
    const auto* type = types_.find(static_cast<std::uint64_t>(Message::getHash()));
    const std::vector<std::byte> bytes = bus::encode(message);
    EXPECT_EQ(appendJson(*type, bytes, text), nullptr);
    return json::parse(text);
  }
  TypeTable types_;
};

TEST_F(JsonText, HasEveryMemberByName) {
  roundabout_msgs::vehicle_states_t states;
  states.utime = 1'700'000'000'123'456;
  states.frame_number = -7;
  for (const std::string name : {"hex1", "he\"x\n2"}) {
    roundabout_msgs::vehicle_state_t state{};
    state.name = name;
    state.position[0] = 0.1;
    state.position[1] = std::numeric_limits<double>::quiet_NaN();
    state.tracked = 1;
    states.vehicles.push_back(state);
  }
  states.num_vehicles = 2;
  const json result = of(states);
  EXPECT_EQ(result["utime"], 1'700'000'000'123'456);
  EXPECT_EQ(result["frame_number"], -7);
  ASSERT_EQ(result["vehicles"].size(), 2u);
  EXPECT_EQ(result["vehicles"][1]["name"], "he\"x\n2");
  EXPECT_EQ(result["vehicles"][0]["position"][0], 0.1);
  EXPECT_TRUE(result["vehicles"][0]["position"][1].is_null());
  EXPECT_EQ(result["vehicles"][0]["tracked"], true);
}

TEST_F(JsonText, SchemaSaysTypesAndUnits) {
  const auto* type =
      types_.find(static_cast<std::uint64_t>(roundabout_msgs::vehicle_states_t::getHash()));
  const json schema = json::parse(jsonSchema(*type));
  EXPECT_EQ(schema["title"], "roundabout_msgs.vehicle_states_t");
  const json& vehicle = schema["properties"]["vehicles"]["items"]["properties"];
  EXPECT_EQ(vehicle["position"]["type"], "array");
  EXPECT_THAT(vehicle["velocity"]["description"].get<std::string>(), HasSubstr("m/s, world"));
  EXPECT_EQ(vehicle["tracked"]["type"], "boolean");
}

class ForeignTypes : public testing::Test {
 protected:
  std::string file(const std::string& text) const {
    writeFile(folder_.file("foreign.lcm"), text);
    return folder_.file("foreign.lcm");
  }
  std::string problem(const std::string& text) const {
    try {
      TypeTable({file(text)});
    } catch (const core::StartupError& error) {
      return error.what();
    }
    return "";
  }
  test::ScratchFolder folder_;
};

// planar_lidar_t has libbot2's layout on purpose: its fingerprint depends on neither package nor
// name.
TEST_F(ForeignTypes, AreFoundByTheirFingerprint) {
  const TypeTable types({file(R"(package bot_core;
/* a comment
   of two lines */ struct planar_lidar_t {
  int64_t utime; int32_t nranges; // how many
  float ranges[nranges];
  int32_t nintensities; float intensities[nintensities];
  float rad0, radstep; })")});
  const auto* type =
      types.find(static_cast<std::uint64_t>(roundabout_msgs::planar_lidar_t::getHash()));
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(type->package, "bot_core");
  EXPECT_EQ(type->comment, "a comment\n   of two lines");
  EXPECT_EQ(type->members[1].comment, "how many");
}

TEST_F(ForeignTypes, ThatCannotBeReadNameTheLine) {
  EXPECT_THAT(problem("package a;\nstruct b {\n int32_t c\n}"), HasSubstr("foreign.lcm:4"));
  EXPECT_THAT(problem("struct b { other_t c; }"), HasSubstr("found other_t"));
  EXPECT_THAT(problem("struct b {"), HasSubstr("the end of the file"));
  EXPECT_THAT(problem("name: spell"), HasSubstr("expected package or struct, found name"));
}

TEST_F(ForeignTypes, MayHaveMatricesBytesAndEachOther) {
  const TypeTable types({file(R"(package a;
struct inner_t { int8_t n; int16_t m[n][2]; }
struct outer_t { int32_t size; byte data[size]; inner_t both[2]; boolean yes; })")});
  // The fingerprint does not matter to walk().
  const std::vector<std::uint8_t> bytes{0, 0,   0,   0,   0, 0, 0, 0,   0,   0, 0,
                                        3, 'M', 'a', 'n', 1, 0, 1, 255, 255, 0, 1};
  const std::string text = readFile(folder_.file("foreign.lcm"));
  auto parsed = parseTypes(text, "foreign.lcm");
  parsed[1]->members[2].message = parsed[0].get();
  EXPECT_NE(types.find(fingerprintOf(*parsed[1])), nullptr);
  std::string json_text;
  ASSERT_EQ(appendJson(*parsed[1], std::as_bytes(std::span(bytes)), json_text), nullptr);
  EXPECT_EQ(json_text,
            R"({"size":3,"data":"TWFu","both":[{"n":1,"m":[[1,-1]]},{"n":0,"m":[]}],"yes":true})");
}

}  // namespace
}  // namespace roundabout::logs
