#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/core/time.h"

namespace roundabout::core {

enum class AgentClass : std::int8_t { kUnknown, kPedestrian, kVehicle, kStatic };

/// As in lcmtypes/agent_track_t.lcm, where the members are explained.
struct AgentTrack {
  std::int32_t id = 0;
  AgentClass agent_class = AgentClass::kUnknown;
  double confidence = 0.0;
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double radius_m = 0.3;
  double position_deviation_m = 0.0;
  double velocity_deviation_mps = 0.0;
  double age_s = 0.0;
  double unseen_s = 0.0;
};

enum class PerceptionHealth : std::int8_t { kGood, kDegraded, kBlind };

/// What perception has refused since it started.
struct PerceptionRejections {
  std::int32_t scans = 0;
  std::int32_t ranges = 0;
  std::int32_t images = 0;
  std::int32_t poses = 0;
};

/// As in lcmtypes/agent_tracks_t.lcm.
struct AgentTracks {
  Utime utime = 0;
  std::string vehicle;
  std::vector<AgentTrack> tracks;
  PerceptionHealth health = PerceptionHealth::kGood;
  std::string reason;
  PerceptionRejections rejected;
  double compute_time_s = 0.0;
};

}  // namespace roundabout::core
