#include "planner/policy_tools/gates/scene.h"

#include <cmath>
#include <filesystem>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include "common/config/document.h"
#include "common/config/reader.h"

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

const Vector2d kNoPlace = Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());

struct SceneEgo {
  Vector2d position_m = kNoPlace;
  Vector2d velocity_mps = Vector2d::Zero();
  std::optional<double> heading_rad;  // nothing: towards the goal
  Vector2d goal_m = kNoPlace;
  double preferred_speed_mps = 1.0;
  double radius_m = 0.5;
};

struct SceneOther {
  Vector2d position_m = kNoPlace;
  Vector2d velocity_mps = Vector2d::Zero();
  double radius_m = 0.5;
};

struct SceneFile {
  SceneEgo ego;
  std::vector<SceneOther> others;
};

template <class Visitor>
void describe(Visitor& visit, SceneEgo& ego) {
  visit("position_m", ego.position_m);
  visit("velocity_mps", ego.velocity_mps);
  visit("heading_rad", ego.heading_rad);
  visit("goal_m", ego.goal_m);
  visit("preferred_speed_mps", ego.preferred_speed_mps, config::above(0.0));
  visit("radius_m", ego.radius_m, config::above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, SceneOther& other) {
  visit("position_m", other.position_m);
  visit("velocity_mps", other.velocity_mps);
  visit("radius_m", other.radius_m, config::above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, SceneFile& file) {
  visit("ego", file.ego);
  visit("others", file.others);
}

void requirePlace(const config::Document& document, const std::string& path,
                  const Vector2d& place_m) {
  if (!place_m.allFinite()) {
    document.fail(path, "[x, y]", "nothing");
  }
}

void requireEverything(const config::Document& document, const SceneFile& file) {
  requirePlace(document, "ego.position_m", file.ego.position_m);
  requirePlace(document, "ego.goal_m", file.ego.goal_m);
  if (file.others.empty()) {
    document.fail("others", "at least one agent", "none");
  }
  for (std::size_t i = 0; i < file.others.size(); ++i) {
    requirePlace(document, fmt::format("others[{}].position_m", i), file.others[i].position_m);
  }
}

core::EgoAgent agentOf(const SceneEgo& ego) {
  const Vector2d to_goal = ego.goal_m - ego.position_m;
  core::EgoAgent agent;
  agent.position_world_m = ego.position_m;
  agent.velocity_world_mps = ego.velocity_mps;
  agent.heading_world_rad = ego.heading_rad.value_or(std::atan2(to_goal.y(), to_goal.x()));
  agent.goal_world_m = ego.goal_m;
  agent.preferred_speed_mps = ego.preferred_speed_mps;
  agent.radius_m = ego.radius_m;
  return agent;
}

}  // namespace

GateScene readGateScene(const std::string& path) {
  const config::Document document(config::textOfFile(path, "scene"), path, {});
  SceneFile file;
  config::Reader reader(document, document.root(), "");
  describe(reader, file);
  reader.finish();
  requireEverything(document, file);

  GateScene scene;
  scene.name = std::filesystem::path(path).stem().string();
  scene.ego = agentOf(file.ego);
  for (const SceneOther& other : file.others) {
    scene.others.push_back({other.position_m, other.velocity_mps, other.radius_m});
  }
  return scene;
}

}  // namespace roundabout::planner
