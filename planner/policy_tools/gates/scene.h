#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/agent.h"

namespace roundabout::planner {

/// One moment among agents, world frame.
struct GateScene {
  std::string name;  ///< of the file, without its ending
  core::EgoAgent ego;
  std::vector<core::OtherAgent> others;
};

/// Reads a scene file (docs/policies.md). Strict: throws core::StartupError with FILE:LINE for
/// unknown keys, wrong values, an ego without place or goal, no others or one without place.
GateScene readGateScene(const std::string& path);

}  // namespace roundabout::planner
