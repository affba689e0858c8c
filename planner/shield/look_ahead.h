#pragma once

#include <array>
#include <optional>
#include <span>

#include "planner/shield/brake_constraints.h"
#include "planner/shield/scene.h"

namespace roundabout::planner::shield {

/// Keeps a policy from commands that the hard layer would soon have to undo: everybody goes on for
/// a second, the ego as its dynamics allow.
class LookAhead {
 public:
  explicit LookAhead(const ShieldParameters& parameters) : parameters_(parameters) {}

  /// The nearest command that stays clear, if the wanted one does not and there is one.
  std::optional<Eigen::Vector2d> instead(const Ego& ego, const Scene& scene,
                                         const BrakeConstraints& constraints,
                                         const Eigen::Vector2d& wanted_mps);

 private:
  void rollOut(const Ego& ego, std::span<const Eigen::Vector2d> velocities_mps);
  bool isClear(const Path& path, const Ego& ego, const Scene& scene) const;

  const ShieldParameters& parameters_;
  std::array<Path, 16> paths_;  // of candidates that are rolled out side by side
};

}  // namespace roundabout::planner::shield
