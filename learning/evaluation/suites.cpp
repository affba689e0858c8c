#include "learning/evaluation/suites.h"

#include <algorithm>
#include <array>
#include <numeric>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/config/words.h"
#include "common/core/error.h"
#include "common/core/random.h"
#include "learning/evaluation/case_file.h"
#include "learning/evaluation/generate.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSeed = 1;

Suite random500() {
  Suite suite{"random500", {}, {}};
  for (const int agents : {2, 3, 4, 6, 8, 10}) {
    GeneratorSettings settings;
    settings.agents = agents;
    settings.half_side_m = publishedHalfSide(agents);
    suite.groups.push_back({agentsText(static_cast<std::size_t>(agents)),
                            generateCases("mixed", settings, 500, kSeed)});
  }
  return suite;
}

Suite table1() {
  Suite suite{"table1", {}, 0.8};
  for (const double radius_m : {0.2, 0.5}) {
    for (const int agents : {2, 4}) {
      GeneratorSettings settings;
      settings.agents = agents;
      settings.min_radius_m = settings.max_radius_m = radius_m;
      settings.min_speed_mps = settings.max_speed_mps = 1.0;
      suite.groups.push_back({fmt::format("{} agents, {} m", agents, radius_m),
                              generateCases("random", settings, 100, kSeed)});
    }
  }
  return suite;
}

Suite crowd() {
  Suite suite{"crowd", {}, {}};
  for (const auto& [agents, half_side_m] : {std::pair(20, 8.0), std::pair(40, 11.0)}) {
    GeneratorSettings settings;
    settings.agents = agents;
    settings.half_side_m = half_side_m;
    settings.max_speed_mps = 2.0;
    settings.min_gap_m = 1.0;
    settings.force_interaction = false;
    suite.groups.push_back({agentsText(static_cast<std::size_t>(agents)),
                            generateCases("random", settings, 10, kSeed)});
  }
  return suite;
}

/// Start, goal, speed, radius.
AgentSpec agent(double x, double y, double goal_x, double goal_y, double speed_mps = 1.0,
                double radius_m = 0.5) {
  return {{x, y}, {goal_x, goal_y}, radius_m, speed_mps};
}

// The published small test suite, as listed in gym-collision-avoidance.
Suite presets() {
  constexpr double kDiagonal = 2.143;
  Suite suite{"presets", {}, {}};
  const auto add = [&](const std::string& name, std::vector<AgentSpec> agents) {
    suite.groups.push_back({name, {TestCase{std::move(agents), {}}}});
  };
  add("swap of two", {agent(-3, 0, 3, 0, 1.0, 0.3), agent(3, 0, -3, 0, 1.0, 0.3)});
  add("crossing at a right angle", {agent(-3, 0, 3, 0), agent(0, -3, 0, 3)});
  add("crossing at a flat angle", {agent(-2, -1.5, 2, 1.5), agent(-2, 1.5, 2, -1.5)});
  add("crossing from the right", {agent(-3, 0, 3, 0, 1.0, 0.3),
                                  agent(kDiagonal, -kDiagonal, -kDiagonal, kDiagonal, 1.0, 0.3)});
  add("swap of unequals", {agent(-2.5, 0, 2.5, 0, 1.0, 0.3), agent(2.5, 0, -2.5, 0, 0.8, 0.4)});
  add("crossing of unequals", {agent(-3, 0, 3, 0, 0.6, 0.5),
                               agent(kDiagonal, -kDiagonal, -kDiagonal, kDiagonal, 1.0, 0.4)});
  add("swap of near equals", {agent(-2, 0, 2, 0, 0.9, 0.35), agent(2, 0, -2, 0, 0.85, 0.45)});
  add("overtaking", {agent(-4, 0, 4, 0, 1.0, 0.4), agent(-2, 0, 2, 0, 0.5, 0.4)});

  add("three ways", circleCase(3, 3.0).agents);
  add("cross of four", circleCase(4, 3.0).agents);
  add("three lanes", {agent(-3, 0, 3, 0), agent(-3, 1.5, 3, 1.5), agent(-3, -1.5, 3, -1.5)});
  add("three lanes, one against",
      {agent(-3, 0, 3, 0), agent(3, 1.5, -3, 1.5), agent(-3, -1.5, 3, -1.5)});
  add("two lanes crossed", {agent(-3, 0, 3, 0), agent(-3, 1.5, 3, 1.5), agent(0, -3, 0, 3)});
  for (const double apart_m : {1.5, 3.0}) {
    add(fmt::format("two swaps {} m apart", apart_m),
        {agent(-3, 0, 3, 0, 1.0, 0.3), agent(3, 0, -3, 0, 1.0, 0.3),
         agent(-3, apart_m, 3, apart_m, 1.0, 0.3), agent(3, apart_m, -3, apart_m, 1.0, 0.3)});
  }
  for (const double apart_m : {0.7, 1.0}) {
    std::vector<AgentSpec> agents;
    for (const double y : {-apart_m, 0.0, apart_m}) {
      agents.push_back(agent(-3, y, 3, y, 1.0, 0.3));
      agents.push_back(agent(3, y, -3, y, 1.0, 0.3));
    }
    add(fmt::format("three swaps {} m apart", apart_m), std::move(agents));
  }
  std::vector<AgentSpec> lanes;
  for (const double y : {0.0, 1.5, -1.5, 3.0, -3.0, -4.5}) {
    lanes.push_back(agent(-3, y, 3, y));
    if (lanes.size() >= 5) {
      add(fmt::format("{} lanes", lanes.size()), lanes);
    }
  }
  add("circle of 5", circleCase(5, 4.0).agents);
  add("circle of 6", circleCase(6, 5.0).agents);
  add("circle of 10", circleCase(10, 5.0).agents);
  add("circle of 20", circleCase(20, 10.0).agents);
  return suite;
}

core::Polygon box(double min_x, double min_y, double max_x, double max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

Suite obstacles() {
  Suite suite{"obstacles", {}, {}};
  const auto add = [&](const std::string& name, std::vector<AgentSpec> agents,
                       std::vector<core::Polygon> polygons) {
    suite.groups.push_back({name, {TestCase{std::move(agents), {}, std::move(polygons)}}});
  };
  const core::Polygon middle = box(-0.5, -0.5, 0.5, 0.5);
  add("alone round a box", {agent(-4, 0, 4, 0, 1.0, 0.3)}, {middle});
  add("swap of two round a box", {agent(-4, 0, 4, 0, 1.0, 0.3), agent(4, 0, -4, 0, 1.0, 0.3)},
      {middle});
  add("swap of four round a box",
      {agent(-4, 0, 4, 0, 1.0, 0.3), agent(4, 0, -4, 0, 1.0, 0.3), agent(0, -4, 0, 4, 1.0, 0.3),
       agent(0, 4, 0, -4, 1.0, 0.3)},
      {middle});
  const std::vector<core::Polygon> walls{box(-3, 1.2, 3, 1.5), box(-3, -1.5, 3, -1.2)};
  add("along a corridor", {agent(-5, 0.5, 5, 0.5, 1.0, 0.3), agent(-5, -0.5, 5, -0.5, 0.6, 0.3)},
      walls);
  add("meeting in a corridor", {agent(-5, 0, 5, 0, 1.0, 0.3), agent(5, 0, -5, 0, 1.0, 0.3)}, walls);
  add("one doorway, one way",
      {agent(-3, 0.5, 3, 0.5, 1.0, 0.3), agent(-3, -0.5, 3, -0.5, 1.0, 0.3)},
      {box(-0.1, 0.7, 0.1, 4), box(-0.1, -4, 0.1, -0.7)});
  add("round an angle", {agent(4, -2, 1, 3, 1.0, 0.3), agent(-3, -1.5, 3, 0, 1.0, 0.3)},
      {{{-1, -1}, {2, -1}, {2, 2}, {1, 2}, {1, 0}, {-1, 0}}});
  GeneratorSettings settings;
  settings.max_radius_m = 0.4;
  for (const double x : {-2.5, 0.0, 2.5}) {
    for (const double y : {-2.5, 0.0, 2.5}) {
      settings.obstacles.push_back(box(x - 0.25, y - 0.25, x + 0.25, y + 0.25));
    }
  }
  suite.groups.push_back({"4 agents, nine pillars", generateCases("random", settings, 100, kSeed)});
  return suite;
}

// Everything is the same from everybody's point of view: nothing but a rule breaks the symmetry.
Suite swaps() {
  Suite suite{"swaps", {{"2 to 30 agents", {}}}, {}};
  for (int agents = 2; agents <= 30; ++agents) {
    suite.groups.front().cases.push_back(circleCase(agents, std::max(3.0, 0.5 * agents)));
  }
  return suite;
}

// The paper's letters, in the order in which they are spelled.
const std::array<std::vector<Vector2d>, 5>& letters() {
  static const std::array<std::vector<Vector2d>, 5> kLetters{
      {{{0, 0}, {-1, 2}, {-1, 4}, {0, 6}, {3, 0}, {3, 6}},
       {{-3, 0}, {3, 0}, {1.5, 3}, {-1.5, 3}, {0, 3}, {0, 6}},
       {{0, 0}, {0, 3}, {0, 6}, {3, 3}, {2.4, 5}, {2.4, 1}},
       {{0, 0}, {0, 3}, {0, 6}, {2.6, 5.6}, {2.4, 3.4}, {3.4, 0}},
       {{0, 0}, {0, 2}, {0, 4}, {0, 6}, {1.5, 0}, {3, 0}}}};
  return kLetters;
}

Suite formation() {
  constexpr int kCases = 100;
  Suite suite{"formation", {{"C A D R L", {}}}, {}};
  for (int k = 0; k < kCases; ++k) {
    core::RandomStream random(kSeed, fmt::format("formation/{}", k));
    TestCase each = circleCase(6, 5.0);
    for (const std::vector<Vector2d>& letter : letters()) {
      std::vector<Vector2d> goals = letter;
      random.shuffle(goals);
      each.later_goals_m.push_back(std::move(goals));
    }
    for (std::size_t i = 0; i < each.agents.size(); ++i) {
      each.agents[i].goal_m = each.later_goals_m.front()[i];
    }
    each.later_goals_m.erase(each.later_goals_m.begin());
    suite.groups.front().cases.push_back(std::move(each));
  }
  return suite;
}

constexpr std::array kSuites = {
    SuiteEntry{
        "random500",
        "500 generated cases each of 2, 3, 4, 6, 8 and 10 agents (paper: numerical comparison)",
        random500},
    SuiteEntry{"table1",
               "100 cases each of 2 and 4 agents of radius 0.2 and 0.5 m (paper: table 1)", table1},
    SuiteEntry{"crowd",
               "10 cases each of 20 and 40 agents (paper: random 20- and 40-agent scenarios)",
               crowd},
    SuiteEntry{"presets",
               "pairs, crossings, lanes, swaps and circles by name (paper: trajectories)", presets},
    SuiteEntry{"obstacles",
               "boxes, corridors, a doorway and 100 cases among pillars; for policies that avoid "
               "obstacles",
               obstacles},
    SuiteEntry{"swaps", "exactly symmetric swaps of 2 to 30 agents on a circle", swaps},
    SuiteEntry{"formation",
               "six agents spell C A D R L, 100 random assignments (paper: formation control)",
               formation},
};

}  // namespace

std::span<const SuiteEntry> suiteTable() { return kSuites; }

Suite makeSuite(const std::string& name) {
  std::vector<std::string> known;
  for (const SuiteEntry& entry : kSuites) {
    if (entry.name == name) {
      return entry.make();
    }
    known.emplace_back(entry.name);
  }
  throw core::StartupError("--suite", "name", fmt::format("one of {}", fmt::join(known, ", ")),
                           config::inQuotes(name));
}

}  // namespace roundabout::learning
