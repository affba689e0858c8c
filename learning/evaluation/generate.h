#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/random.h"
#include "learning/evaluation/test_case.h"

namespace roundabout::learning {

/// What generated cases have in common. The generator is the one behind the published test sets
/// (gym-collision-avoidance, gen_rand_testcases); its rules are in docs/evaluation.md.
struct GeneratorSettings {
  int agents = 4;
  double half_side_m = 4.0;  ///< places lie in a square of twice this
  double min_radius_m = 0.2;
  double max_radius_m = 0.8;
  double min_speed_mps = 0.5;
  double max_speed_mps = 1.5;
  double min_gap_m = 0.2;  ///< between edges at the start, and at the goals
  bool force_interaction = true;
  std::vector<core::Polygon> obstacles;  ///< edges keep the gap from them too
  /// Places may spread by this factor while room is sought; a case that needs more is drawn anew.
  /// The published generator knows no such bound.
  double max_growth = std::numeric_limits<double>::infinity();
};

/// m: half the side of the square in which the published sets of so many agents begin.
constexpr double publishedHalfSide(int agents) { return agents < 10 ? 4.0 : 6.0; }

/// Kinds of generated cases: "random", "circle", "swap", and "mixed" (70, 15 and 15 %).
std::span<const std::string_view> generatorKinds();

/// Case k depends on kind, settings, seed and k alone. Throws core::StartupError ("--generate") for
/// an unknown kind or settings without a solution.
std::vector<TestCase> generateCases(const std::string& kind, const GeneratorSettings& settings,
                                    int count, std::uint64_t seed);

/// One case, drawn from a stream. Throws as generateCases().
TestCase generateCase(const std::string& kind, const GeneratorSettings& settings,
                      core::RandomStream& random);

/// Agents of radius 0.5 m and 1 m/s on a circle, each bound for the opposite side.
TestCase circleCase(int agents, double radius_m);

}  // namespace roundabout::learning
