#include "learning/evaluation/obstacle_course.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "common/config/obstacles.h"
#include "common/core/error.h"
#include "common/core/polygon.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

/// Where: the case, for errors.
void checkPlace(const TestCase& test_case, std::size_t agent, const Vector2d& place_m,
                const char* what, const std::string& where) {
  const double radius_m = test_case.agents[agent].radius_m;
  for (const core::Polygon& obstacle : test_case.obstacles) {
    const double distance_m = core::distanceTo(obstacle, place_m);
    if (distance_m <= radius_m) {
      throw core::StartupError(
          where, fmt::format("agent {}, {}", agent, what),
          fmt::format("more than its radius, {} m, from every obstacle", radius_m),
          distance_m < 0.0 ? "a place inside one" : fmt::format("{:.3f} m", distance_m));
    }
  }
}

void checkPlaces(const TestCase& test_case, const std::string& where) {
  for (std::size_t i = 0; i < test_case.agents.size(); ++i) {
    checkPlace(test_case, i, test_case.agents[i].start_m, "start", where);
    checkPlace(test_case, i, test_case.agents[i].goal_m, "goal", where);
    for (const std::vector<Vector2d>& goals_m : test_case.later_goals_m) {
      checkPlace(test_case, i, goals_m[i], "goal", where);
    }
  }
}

void requireAvoidance(const Contestant& contestant, const char* option) {
  if (!contestant.prototype->avoidsObstacles()) {
    throw core::StartupError("evaluate", option, "a policy that avoids obstacles",
                             std::string(contestant.prototype->name()));
  }
}

}  // namespace

void addObstacles(Suite& suite, const std::string& path) {
  const std::vector<core::Polygon> outlines = config::outlinesOf(config::readObstacles(path));
  for (CaseGroup& group : suite.groups) {
    for (TestCase& each : group.cases) {
      each.obstacles.insert(each.obstacles.end(), outlines.begin(), outlines.end());
    }
  }
}

void checkObstacles(const Evaluation& evaluation) {
  bool any = false;
  for (const CaseGroup& group : evaluation.suite.groups) {
    for (std::size_t k = 0; k < group.cases.size(); ++k) {
      any = any || !group.cases[k].obstacles.empty();
      checkPlaces(group.cases[k],
                  fmt::format("{}, {}, case {}", evaluation.suite.name, group.name, k));
    }
  }
  if (!any) {
    return;
  }
  for (const Contestant& contestant : evaluation.contestants) {
    requireAvoidance(contestant, "--policy");
  }
  if (evaluation.mix) {
    requireAvoidance(evaluation.mix->others, "--mix");
  }
}

}  // namespace roundabout::learning
