#include "learning/evaluation/generate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/config/words.h"
#include "common/core/error.h"
#include "common/core/polygon.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

constexpr std::array<std::string_view, 4> kKinds{"mixed", "random", "circle", "swap"};
constexpr double kGrowth = 1.01;
constexpr int kTriesBeforeGrowth = 10;
constexpr int kPatience = 10'000;
constexpr int kMaxTries = 100'000;
constexpr double kFullTurn_rad = 2.0 * std::numbers::pi;

bool keepsGaps(const AgentSpec& agent, std::span<const AgentSpec> earlier, double gap_m) {
  return std::all_of(earlier.begin(), earlier.end(), [&](const AgentSpec& other) {
    const double apart_m = agent.radius_m + other.radius_m + gap_m;
    return (agent.start_m - other.start_m).norm() >= apart_m &&
           (agent.goal_m - other.goal_m).norm() >= apart_m;
  });
}

bool clearOf(std::span<const core::Polygon> obstacles, const AgentSpec& agent, double gap_m) {
  return std::all_of(obstacles.begin(), obstacles.end(), [&](const core::Polygon& obstacle) {
    const double apart_m = agent.radius_m + gap_m;
    return core::distanceTo(obstacle, agent.start_m) >= apart_m &&
           core::distanceTo(obstacle, agent.goal_m) >= apart_m;
  });
}

/// Two agents that go straight at preferred speed, each until it arrives, come closer than their
/// radii and the gap.
bool conflict(const AgentSpec& a, const AgentSpec& b, double gap_m) {
  const auto closestDuring = [&](const Vector2d& from, const Vector2d& velocity,
                                 double duration_s) {
    const double speed_squared = velocity.squaredNorm();
    const double time_s = speed_squared > 0.0
                              ? std::clamp(-from.dot(velocity) / speed_squared, 0.0, duration_s)
                              : 0.0;
    return (from + time_s * velocity).norm();
  };
  const Vector2d way_a = a.goal_m - a.start_m;
  const Vector2d way_b = b.goal_m - b.start_m;
  const double time_a_s = way_a.norm() / a.preferred_speed_mps;
  const double time_b_s = way_b.norm() / b.preferred_speed_mps;
  const Vector2d velocity_a = way_a / time_a_s;
  const Vector2d velocity_b = way_b / time_b_s;
  const double both_s = std::min(time_a_s, time_b_s);
  const double only_s = std::max(time_a_s, time_b_s) - both_s;
  const Vector2d start = a.start_m - b.start_m;
  const Vector2d then = start + both_s * (velocity_a - velocity_b);
  const Vector2d alone = time_a_s > time_b_s ? velocity_a : Vector2d(-velocity_b);
  const double closest_m = std::min(closestDuring(start, velocity_a - velocity_b, both_s),
                                    closestDuring(then, alone, only_s));
  return closest_m <= a.radius_m + b.radius_m + gap_m;
}

/// Makes one case.
class Generator {
 public:
  Generator(const GeneratorSettings& settings, core::RandomStream& random)
      : settings_(settings), random_(random) {}

  TestCase make(std::string_view kind) {
    if (kind == "mixed") {
      const double draw = random_.uniform(0.0, 1.0);
      kind = draw < 0.15 ? "swap" : draw < 0.3 ? "circle" : "random";
    }
    if (kind == "random") {
      std::optional<TestCase> result;
      while (!(result = randomCase())) {
      }
      return *result;
    }
    TestCase result;
    const double radius_m = 0.5 * settings_.agents + random_.uniform(0.0, 2.0);
    if (kind == "circle") {
      addCrossing(result, {0.0, 0.0}, radius_m);
      return result;
    }
    addSwap(result);
    if (settings_.agents > 2) {
      const double side = random_.chance(0.5) ? 1.0 : -1.0;
      addCrossing(result, {0.0, side * (1.0 + radius_m)}, radius_m);
    }
    return result;
  }

 private:
  AgentSpec agent() {
    AgentSpec spec;
    spec.radius_m = random_.uniform(settings_.min_radius_m, settings_.max_radius_m);
    // The larger of two draws: fast agents are more common.
    const double draw = random_.uniform(settings_.min_speed_mps, settings_.max_speed_mps);
    spec.preferred_speed_mps =
        std::max(draw, random_.uniform(settings_.min_speed_mps, settings_.max_speed_mps));
    return spec;
  }

  /// Nothing if the places would spread too far.
  std::optional<TestCase> randomCase() {
    TestCase result;
    double half_side_m = settings_.half_side_m;
    const auto place = [&] {
      const double x = random_.uniform(-half_side_m, half_side_m);
      return Vector2d(x, random_.uniform(-half_side_m, half_side_m));
    };
    while (result.agents.size() < static_cast<std::size_t>(settings_.agents)) {
      AgentSpec spec = agent();
      do {
        spec.start_m = place();
        spec.goal_m = place();
        // Who has to meet others has to look for a place in any case.
        half_side_m *= settings_.force_interaction || tries_ > kPatience ? kGrowth : 1.0;
        if (half_side_m > settings_.max_growth * settings_.half_side_m) {
          return std::nullopt;
        }
        countTry();
      } while (!acceptable(spec, result.agents, half_side_m));
      result.agents.push_back(spec);
    }
    return result;
  }

  bool acceptable(const AgentSpec& spec, std::span<const AgentSpec> earlier,
                  double half_side_m) const {
    const auto meets = [&](const AgentSpec& other) {
      return conflict(spec, other, settings_.min_gap_m);
    };
    return keepsGaps(spec, earlier, settings_.min_gap_m) && isClear(spec) &&
           (spec.goal_m - spec.start_m).norm() > 0.5 * half_side_m &&
           (!settings_.force_interaction || earlier.empty() ||
            std::any_of(earlier.begin(), earlier.end(), meets));
  }

  bool isClear(const AgentSpec& spec) const {
    return clearOf(settings_.obstacles, spec, settings_.min_gap_m);
  }

  void addSwap(TestCase& result) {
    do {
      result.agents.clear();
      const double away_m = 1.5 + random_.uniform(0.0, 2.0);
      for (const double side : {-1.0, 1.0}) {
        if (result.agents.size() < static_cast<std::size_t>(settings_.agents)) {
          AgentSpec spec = agent();
          spec.start_m = {side * away_m, 0.0};
          spec.goal_m = {-side * away_m, 0.0};
          result.agents.push_back(spec);
        }
      }
      countTry();
    } while (!std::all_of(result.agents.begin(), result.agents.end(),
                          [this](const AgentSpec& spec) { return isClear(spec); }));
  }

  void addCrossing(TestCase& result, const Vector2d& centre_m, double radius_m) {
    while (result.agents.size() < static_cast<std::size_t>(settings_.agents)) {
      AgentSpec spec = agent();
      for (int tries = 1;; ++tries) {
        const double angle_rad = random_.uniform(0.0, kFullTurn_rad);
        const Vector2d out = radius_m * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
        spec.start_m = centre_m + out;
        spec.goal_m = centre_m - out;
        if (keepsGaps(spec, result.agents, settings_.min_gap_m) && isClear(spec)) {
          break;
        }
        radius_m *= tries % kTriesBeforeGrowth == 0 ? kGrowth : 1.0;
        countTry();
      }
      result.agents.push_back(spec);
    }
  }

  void countTry() {
    if (++tries_ > kMaxTries) {
      throw core::StartupError("--generate", "settings", "agents that can be placed",
                               fmt::format("no place after {} tries", kMaxTries));
    }
  }

  const GeneratorSettings& settings_;
  core::RandomStream& random_;
  int tries_ = 0;
};

}  // namespace

std::span<const std::string_view> generatorKinds() { return kKinds; }

TestCase generateCase(const std::string& kind, const GeneratorSettings& settings,
                      core::RandomStream& random) {
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end()) {
    throw core::StartupError("--generate", "kind",
                             fmt::format("one of {}", fmt::join(kKinds, ", ")),
                             config::inQuotes(kind));
  }
  TestCase result = Generator(settings, random).make(kind);
  result.obstacles = settings.obstacles;
  return result;
}

std::vector<TestCase> generateCases(const std::string& kind, const GeneratorSettings& settings,
                                    int count, std::uint64_t seed) {
  std::vector<TestCase> cases;
  for (int k = 0; k < count; ++k) {
    core::RandomStream random(seed, fmt::format("cases/{}/{}/{}", kind, settings.agents, k));
    cases.push_back(generateCase(kind, settings, random));
  }
  return cases;
}

TestCase circleCase(int agents, double radius_m) {
  TestCase result;
  for (int i = 0; i < agents; ++i) {
    const double angle_rad = kFullTurn_rad * i / agents;
    const Vector2d out = radius_m * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    result.agents.push_back({out, -out, 0.5, 1.0});
  }
  return result;
}

}  // namespace roundabout::learning
