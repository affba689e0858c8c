#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <lcm/eventlog.h>
#include <nlohmann/json.hpp>

#include "common/bus/messages.h"
#include "common/core/error.h"
#include "logs/compare/compare.h"
#include "logs/export/csv.h"
#include "logs/export/cut.h"
#include "logs/export/mcap.h"
#include "logs/files.h"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/npm.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

using Row = std::vector<std::string>;

/// A parser of its own, for RFC 4180.
std::vector<Row> parseCsv(const std::string& text) {
  std::vector<Row> rows{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') {
      const bool escaped = quoted && i + 1 < text.size() && text[i + 1] == '"';
      if (escaped) {
        rows.back().back() += '"';
        ++i;
      } else {
        quoted = !quoted;
      }
    } else if (text[i] == ',' && !quoted) {
      rows.back().emplace_back();
    } else if (text[i] == '\n' && !quoted) {
      rows.push_back({""});
    } else {
      rows.back().back() += text[i];
    }
  }
  rows.pop_back();
  return rows;
}

class Export : public testing::Test {
 protected:
  Export() {
    SyntheticFlight flight;
    flight.vehicles = {{"hex1", straight({0, 0, 1}, {3, 0, 1}, 0.5)},
                       {"hex2", standing({0, 4, 1})}};
    flight.vehicles[1].untracked_from_s = 1.0;
    flight.vehicles[1].untracked_to_s = 2.0;
    flight.duration_s = 4.0;
    flight.write(log());
  }

  std::string log() const { return folder_.file("flight.lcm"); }

  static std::size_t column(const Row& header, const std::string& name) {
    const auto found = std::find(header.begin(), header.end(), name);
    EXPECT_NE(found, header.end()) << name;
    return static_cast<std::size_t>(found - header.begin());
  }

  test::ScratchFolder folder_;
  TypeTable types_;
};

TEST_F(Export, CsvHasATableAChannelWithUnitsInTheHeader) {
  const EventLog events(log());
  const auto files = writeChannelTables(events, types_, folder_.path().string());
  std::size_t rows = 0;
  for (const CsvFile& file : files) {
    EXPECT_EQ(file.problem, "");
    EXPECT_EQ(parseCsv(readFile(file.file)).size(), file.rows + 1);
    rows += file.rows;
  }
  EXPECT_EQ(rows, events.size());
  const auto states = parseCsv(readFile(folder_.file("VEHICLE_STATES.csv")));
  const Row& header = states[0];
  const std::size_t x = column(header, "vehicles[0].position[0] (m)");
  const std::size_t speed = column(header, "vehicles[0].velocity[0] (m/s)");
  column(header, "vehicles[1].angular_velocity[2] (rad/s)");
  EXPECT_NEAR(std::stod(states[401][x]), 1.0, 1e-6);  // 2 s at 0.5 m/s
  EXPECT_NEAR(std::stod(states[401][speed]), 0.5, 1e-6);
  for (const Row& row : states) {
    EXPECT_EQ(row.size(), header.size());
  }
}

TEST_F(Export, CsvSpreadsListsAsFarAsTheLongestNeeds) {
  const std::string file = folder_.file("mixed.lcm");
  {
    LogWriter writer(file);
    roundabout_msgs::mission_t mission{};
    mission.verb = "say \"a, b\"";
    writer.write(1, "MISSION", mission);
    mission.verb = "formation";
    mission.points = {{1, 2, 3}, {4, 5, 6}};
    mission.num_points = 2;
    writer.write(2, "MISSION", mission);
    const std::vector<std::byte> foreign(12, std::byte{7});
    writer.writeBytes(3, "FOREIGN", foreign);
    writer.writeBytes(4, "MISSION", foreign);
  }
  const auto files = writeChannelTables(EventLog(file), types_, folder_.path().string());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_THAT(files[0].problem, HasSubstr("0707070707070707 is not known"));
  EXPECT_EQ(files[1].rows, 2u);
  EXPECT_EQ(files[1].rejected, 1u);
  const auto rows = parseCsv(readFile(files[1].file));
  EXPECT_EQ(rows[1].size(), rows[0].size());
  EXPECT_EQ(rows[2].size(), rows[0].size());
  EXPECT_EQ(rows[1][column(rows[0], "verb")], "say \"a, b\"");
  EXPECT_EQ(rows[1][column(rows[0], "points[1][2] (m)")], "");
  EXPECT_EQ(rows[2][column(rows[0], "points[1][2] (m)")], "6");
}

TEST_F(Export, VehicleTableHasARowAVehicleAndFrame) {
  const Flight flight = readFlight(log());
  const CsvFile file = writeVehicleTable(flight, folder_.file("vehicles.csv"));
  const auto rows = parseCsv(readFile(file.file));
  ASSERT_EQ(rows.size(), 1 + 2 * flight.frames.size());
  EXPECT_EQ(file.rows, rows.size() - 1);
  const Row& hex1 = rows[1 + 2 * 300];
  EXPECT_EQ(hex1[column(rows[0], "vehicle")], "hex1");
  EXPECT_EQ(hex1[column(rows[0], "time (s)")], "1.500000");
  EXPECT_NEAR(std::stod(hex1[column(rows[0], "x (m)")]), 0.75, 1e-6);
  const Row& hex2 = rows[2 + 2 * 300];
  EXPECT_EQ(hex2[column(rows[0], "tracked")], "0");
  EXPECT_EQ(hex2[column(rows[0], "y (m)")], "");
}

TEST_F(Export, CutHoldsTheChosenEventsAndLcmReadsIt) {
  const EventLog events(log());
  CutOptions options;
  options.from_s = 0.1;
  options.to_s = 0.2;
  options.only = {"VEHICLE_.*", "COMMAND_hex[12]"};
  options.except = {"COMMAND_hex2"};
  const std::string file = folder_.file("cut.lcm");
  const std::size_t count = cutLog(events, options, file);
  std::size_t expected = 0;
  for (const Event& event : events) {
    const double at_s = core::toSeconds(event.log_utime - events[0].log_utime);
    const bool wanted = event.channel == "VEHICLE_STATES" || event.channel == "COMMAND_hex1";
    expected += wanted && at_s >= 0.1 && at_s <= 0.2 ? 1 : 0;
  }
  EXPECT_GT(expected, 10u);
  EXPECT_EQ(count, expected);
  std::size_t read = 0;
  lcm_eventlog_t* by_lcm = lcm_eventlog_create(file.c_str(), "r");
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(by_lcm)) {
    EXPECT_EQ(event->eventnum, static_cast<std::int64_t>(read++));
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(by_lcm);
  EXPECT_EQ(read, count);
}

TEST_F(Export, CutRefusesToReplaceTheLog) {
  const EventLog events(log());
  EXPECT_THROW(cutLog(events, {}, log()), core::StartupError);
  CutOptions bad;
  bad.only = {"("};
  EXPECT_THROW(cutLog(events, bad, folder_.file("x")), core::StartupError);
}

TEST_F(Export, CompareSaysWhereFlightsPart) {
  const Flight same = readFlight(log());
  const FlightDifference none = compareFlights(same, same, 0.01);
  EXPECT_FALSE(none.statesPart());
  EXPECT_FALSE(none.commandsPart());
  EXPECT_GT(none.vehicles[0].commands, 30);
  EXPECT_EQ(none.vehicles[0].commands, none.vehicles[0].equal_commands);

  Flight other = same;
  for (std::size_t i = 0; i < other.frames.size(); ++i) {
    other.frames[i].utime += 77'000'000;  // begun at another time
    if (i >= 400) {
      other.vehicles[0].samples[i].position_world_m.y() += 0.001 * static_cast<double>(i - 400);
    }
  }
  for (auto& command : other.vehicles[0].commands) {
    command.value.state_utime += 77'000'000;
    if (command.value.state_utime >= other.frames[600].utime) {
      command.value.velocity_world_mps.x() += 1e-15;
    }
  }
  const FlightDifference difference = compareFlights(same, other, 0.01);
  EXPECT_EQ(difference.frames_in_both, static_cast<int>(same.frames.size()));
  const VehicleDifference& hex1 = difference.vehicles[0];
  ASSERT_TRUE(hex1.states_part_at_s && hex1.commands_part_at_s);
  EXPECT_NEAR(*hex1.states_part_at_s, 2.055, 1e-6);
  EXPECT_NEAR(hex1.furthest_m, 0.4, 1e-6);
  EXPECT_NEAR(*hex1.commands_part_at_s, 3.0, 0.11);
  EXPECT_FALSE(difference.vehicles[1].states_part_at_s);
  EXPECT_THAT(toText(difference, 0.01), HasSubstr("2.055 s"));
}

/// What Foxglove's own reader says about a file; skips the test where it is not to be had.
class Mcap : public Export {
 protected:
  void SetUp() override {
    if (!mcap_core_.problem.empty()) {
      GTEST_SKIP() << mcap_core_.problem;
    }
  }

  nlohmann::json readWithMcapCore(const std::string& file) const {
    const std::string out = folder_.file("mcap.json");
    const std::string command = "NODE_PATH='" + mcap_core_.modules.string() +
                                "' node '" ROUNDABOUT_SOURCE_DIR "/tests/logs/read_mcap.js' '" +
                                file + "' > '" + out + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return nlohmann::json::parse(readFile(out));
  }

  const test::NpmPackage mcap_core_ = test::npmPackage("@mcap/core", "2.2.2");
};

TEST_F(Mcap, OfAFlightIsReadWholeByMcapCore) {
  const EventLog events(log());
  const std::string file = folder_.file("flight.mcap");
  const McapResult result = writeMcap(events, types_, McapClock::kLog, file);
  EXPECT_EQ(result.messages, events.size());
  EXPECT_EQ(result.raw + result.rejected, 0u);
  std::map<std::string, int> expected;
  for (const Event& event : events) {
    ++expected[std::string(event.channel)];
  }
  const nlohmann::json read = readWithMcapCore(file);
  EXPECT_EQ(read["messages"], events.size());
  EXPECT_EQ(read["statistics"], events.size());
  EXPECT_EQ(read["topics"].get<decltype(expected)>(), expected);
  EXPECT_EQ(read["streamed"], events.size());
  EXPECT_EQ(read["begin_ns"], std::to_string(events[0].log_utime) + "000");
  EXPECT_GT(read["chunks"], 1);
  EXPECT_EQ(read["last"]["VEHICLE_STATES"]["vehicles"][0]["name"], "hex1");
  EXPECT_EQ(read["schemas"]["COMMAND_hex1"], "roundabout_msgs.command_t");
}

TEST_F(Mcap, KeepsMessagesOfUnknownTypesAsTheyAre) {
  const std::string file = folder_.file("mixed.lcm");
  {
    LogWriter writer(file);
    const std::vector<std::byte> foreign(12, std::byte{7});
    writer.writeBytes(1'000, "FOREIGN", foreign);
    writer.write(2'000, "SAFETY_ORDER", bus::toMessage(core::SafetyOrder{}));
    writer.writeBytes(3'000, "SAFETY_ORDER", foreign);
  }
  const McapResult result =
      writeMcap(EventLog(file), types_, McapClock::kLog, folder_.file("mixed.mcap"));
  EXPECT_EQ(result.raw, 1u);
  EXPECT_EQ(result.rejected, 1u);
  const nlohmann::json read = readWithMcapCore(folder_.file("mixed.mcap"));
  EXPECT_EQ(read["messages"], 2);
  EXPECT_EQ(read["schemas"]["FOREIGN"], nullptr);
}

}  // namespace
}  // namespace roundabout::logs
