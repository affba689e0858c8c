#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/core/agent.h"
#include "common/core/shield_layer.h"
#include "planner/shield/motion.h"
#include "planner/shield/parameters.h"

namespace roundabout::planner::shield {

/// The vehicle that is shielded.
struct Ego {
  Motion motion;
  MotionBounds bounds;
  double radius_m = 0.5;  ///< of what must not be touched
  Eigen::Vector2d goal_world_m = Eigen::Vector2d::Zero();
  double preferred_speed_mps = 1.0;
  double max_speed_mps = 1.0;  ///< of what is commanded
  int id = 0;                  ///< differs from that of every neighbour
  bool parked = false;         ///< at its goal: stands there, steps aside for who asks, returns
  /// Policies slow down before a goal, not before a place on the way to it.
  bool goal_is_final = true;
};

/// Another vehicle. `motion.age_s` grows while it is not tracked.
struct Neighbour {
  Motion motion;
  MotionBounds bounds;
  /// Of the body, and what it may have strayed from its commands since it was measured.
  double radius_m = 0.5;
  double max_speed_mps = 1.0;
  int id = 0;                 ///< the same in every call
  bool shielded = true;       ///< gives half of the gap; its commands are known
  bool parked = false;        ///< stands, and will go on standing: at its goal, held, on the floor
  bool gives_way = false;     ///< parked, but steps aside if asked to
  bool asks_for_way = false;  ///< of those that are parked in its way
  /// Where it wants to go next; not finite: not known.
  Eigen::Vector2d goal_world_m =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// The positions p with normal . p <= offset: a wall of the room, seen from inside.
struct Wall {
  Eigen::Vector2d normal;  ///< unit, out of the room
  double offset_m = 0.0;
};

/// What does not move. World frame.
struct Statics {
  std::span<const Wall> walls{};
  std::span<const core::Polygon> obstacles{};  ///< and no-fly zones; from the floor up
  /// Near pieces of what only a map knows. The hard layer keeps off them as off obstacles; the way
  /// round them is the business of whoever says where the goal is.
  std::span<const core::Polygon> mapped{};
  double mapped_slack_m = 0.0;  ///< they may come nearer than the margin by this
};

using Layer = core::ShieldLayer;
using core::nameOf;

struct ShieldDecision {
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();  ///< to be flown for hold_s
  Eigen::Vector2d wanted_world_mps = Eigen::Vector2d::Zero();
  Layer layer = Layer::kNone;
  /// Between the edges of the brake paths of the ego and of whoever comes nearest; infinite: nobody
  /// is near. m.
  double predicted_gap_m = std::numeric_limits<double>::infinity();
  bool asks_for_way = false;  ///< of the vehicles that are parked in the way; tell them
};

/// Guards one vehicle's velocity commands; docs/shield.md has the rules, the theorem and what it
/// assumes. Remembers only who is getting on (for the breaker). Deterministic; the order of
/// neighbours changes nothing. Allocates nothing once it has seen as many neighbours and
/// statics.
class Shield {
 public:
  explicit Shield(const ShieldParameters& parameters);
  ~Shield();
  Shield(Shield&&) noexcept;
  Shield& operator=(Shield&&) noexcept;

  /// The velocity to fly instead of `wanted_world_mps`: that one if nothing is against it, bit for
  /// bit. The command must be issued now and expire after parameters().hold_s. All inputs are
  /// finite, save for unknown goals. now_s: any clock that does not go back.
  ShieldDecision decide(const Ego& ego, std::span<const Neighbour> neighbours,
                        const Statics& statics, const Eigen::Vector2d& wanted_world_mps,
                        double now_s);

  /// A new flight, or a new goal, begins.
  void reset();

  const ShieldParameters& parameters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace roundabout::planner::shield
