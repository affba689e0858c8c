// The rules of DESIGN section 2 and 3 that a compiler does not check: who may include whom.

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = ROUNDABOUT_SOURCE_DIR;

struct Include {
  std::string file;    // relative to the root
  std::string target;  // as written between the quotes or brackets
};

std::vector<fs::path> sourcesUnder(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const std::string extension = entry.path().extension();
    if (extension == ".h" || extension == ".cpp") {
      files.push_back(entry.path());
    }
  }
  return files;
}

std::vector<Include> includesUnder(const std::string& folder) {
  static const std::regex kInclude(R"(^\s*#include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  for (const fs::path& file : sourcesUnder(folder)) {
    std::ifstream stream(file);
    std::string line;
    while (std::getline(stream, line)) {
      std::smatch match;
      if (std::regex_search(line, match, kInclude)) {
        includes.push_back({fs::relative(file, kRoot), match[1]});
      }
    }
  }
  return includes;
}

void expectNone(const std::string& folder, const std::string& forbidden,
                const std::string& except_files = "^$") {
  const std::regex pattern(forbidden);
  const std::regex exceptions(except_files);
  const auto includes = includesUnder(folder);
  ASSERT_FALSE(includes.empty()) << folder << " has no sources: the rule guards nothing";
  for (const Include& include : includes) {
    if (!std::regex_search(include.file, exceptions)) {
      EXPECT_FALSE(std::regex_search(include.target, pattern))
          << include.file << " includes " << include.target;
    }
  }
}

const std::string kWire = R"(^lcm/|^roundabout_msgs/|^common/bus/)";

TEST(Architecture, CommonCoreStandsAlone) {
  expectNone("common/core", R"(^common/(?!core/)|^lcm/|yaml|spdlog|CLI)");
}

TEST(Architecture, ConfigurationKnowsOnlyCore) {
  expectNone("common/config", R"(^common/(bus|app)/|^lcm/)");
}

TEST(Architecture, CommonKnowsNoModule) {
  expectNone("common", R"(^(mocap_bridge|planner|fleet|perception|sim|learning|logs|cli)/)");
}

TEST(Architecture, AlgorithmsKnowNoWire) {
  // Nodes and programs are the thin part that does.
  const std::string nodes = R"((_node|/run_\w+|/main)\.(h|cpp)$)";
  expectNone("planner", kWire, nodes);
  expectNone("fleet", kWire, nodes);
  expectNone("sim", kWire, nodes + R"(|_pacing\.(h|cpp)$)");
  expectNone("learning", kWire);
  expectNone("perception", kWire, nodes + R"(|^perception/watch/)");
  expectNone("mocap_bridge", kWire,
             nodes + R"(|state_publisher\.(h|cpp)$|replay/event_log\.cpp$|tools/emulate\.cpp$)");
  expectNone("mocap_bridge/estimation", kWire + R"(|^sys/|^netinet/|^poll\.h|chrono)");
}

TEST(Architecture, ModulesDoNotKnowEachOther) {
  expectNone("planner", R"(^(mocap_bridge|fleet|sim|learning|logs|cli)/)");
  expectNone("fleet", R"(^(mocap_bridge|planner|sim|learning|logs|cli)/)");
  expectNone("logs", R"(^(mocap_bridge|planner|fleet|sim|learning|cli)/)");
  expectNone("mocap_bridge", R"(^(planner|fleet|sim|learning|logs|cli)/)");
  expectNone("perception", R"(^(mocap_bridge|planner|fleet|sim|learning|logs|cli)/)");
  // Learning and evaluation use the cores of the simulator and the planner.
  expectNone("learning", R"(^(mocap_bridge|fleet|logs|cli)/)");
  // The one exception of DESIGN section 3: the simulator publishes through the bridge's
  // StatePublisher.
  expectNone("sim", R"(^(planner|fleet|learning|logs|cli)/|^mocap_bridge/(?!state_publisher))",
             R"(^sim/pedestrians/policy_steering\.cpp$)");
  // And pedestrians walk by any policy of the table.
  expectNone("sim/pedestrians", R"(^planner/(?!policies/table\.h))");
}

TEST(Architecture, VisionAndLearningLibrariesStayOutside) {
  for (const char* folder : {"common", "mocap_bridge", "planner", "fleet", "sim", "logs", "cli"}) {
    expectNone(folder, R"(^opencv|^octomap|^torch/|^ATen/|^c10/)");
  }
  // One file of it, in a library of its own.
  expectNone("learning", R"(^torch/|^ATen/|^c10/)", "^learning/torch/");
}

// It would cost every program half a second at its start.
TEST(Architecture, NoProgramIsLinkedWithLibtorch) {
  int programs = 0;
  for (const auto& entry : fs::directory_iterator(ROUNDABOUT_BIN_DIR)) {
    if (!entry.is_regular_file() || entry.path().filename() == "libroundabout_torch.so") {
      continue;
    }
    ++programs;
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(stream), {});
    EXPECT_EQ(bytes.find("libtorch_cpu.so"), std::string::npos) << entry.path();
    EXPECT_EQ(bytes.find("libc10.so"), std::string::npos) << entry.path();
  }
  EXPECT_GE(programs, 1);
}

TEST(Architecture, VisionLibrariesStayInFewFiles) {
  expectNone(
      "perception", R"(^opencv|^octomap)",
      R"(vision/(network|person|opencv)_(detector|output)\.(h|cpp)$|mapping/occupancy_mapper\.cpp$|)"
      R"(watch/\w+\.cpp$)");
}

TEST(Architecture, EveryMainIsShort) {
  int mains = 0;
  for (const char* folder : {"mocap_bridge", "planner", "fleet", "perception", "sim", "cli"}) {
    for (const fs::path& file : sourcesUnder(folder)) {
      if (file.filename() != "main.cpp") {
        continue;
      }
      ++mains;
      std::ifstream stream(file);
      const auto lines = std::count(std::istreambuf_iterator<char>(stream),
                                    std::istreambuf_iterator<char>(), '\n');
      EXPECT_LT(lines, 40) << file;
    }
  }
  EXPECT_GE(mains, 6);
}

}  // namespace
