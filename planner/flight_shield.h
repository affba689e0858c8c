#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "planner/safety/command_book.h"
#include "planner/shield/observer.h"
#include "planner/shield/shield.h"
#include "planner/situation.h"
#include "planner/status.h"

namespace roundabout::planner {

/// The shield in the planner process: what tracks, commands and the experiment file say becomes
/// what planner::shield::Shield is told, and what it decides becomes a command. With shield.on:
/// false, or for a vehicle that is not shielded, it keeps it off walls, obstacles and no-fly zones
/// only.
class FlightShield {
 public:
  FlightShield(const config::Experiment& experiment, std::size_t own_index);

  /// What another planner commands its vehicle. Returns why it is refused; nullptr: it is not.
  const char* onCommand(const core::Command& command, core::Utime newest_frame);

  /// Call on every tick, before guard().
  void observe(core::Utime now, const Situation& situation);

  /// What a map says, beside the experiment file.
  struct Mapped {
    std::span<const core::Polygon> pieces{};        ///< near ones of what stands there
    std::optional<Eigen::Vector2d> next_place_m{};  ///< on the way to the goal
  };

  /// A VELOCITY or POSITION command becomes one that the shield lets pass; of others nothing
  /// changes. Says in the status what became of it.
  void guard(core::Utime now, const Situation& situation, const Mapped& mapped,
             core::Command& command, Status& status);

  /// The command that leaves the planner on a tick.
  void onSent(const core::Command& command, const Situation& situation);

  /// No frames came, and from a time on the planner told its vehicle to hold: known by the frames
  /// alone, so that a replay knows it too.
  void noteSilence(core::Utime since, const Situation& situation);

  /// Another goal.
  void noteNewGoal();
  /// The states' time went back.
  void beginAnew();

 private:
  Eigen::Vector2d velocityOf(const core::Command& command, const Track& track,
                             std::size_t vehicle) const;
  void setHeights(const Track& track, const core::Command* in_force, shield::Motion& motion) const;
  bool holdsPlace(const core::Command& command, const core::VehicleState& state) const;
  bool wouldSurprise(bool stays, const Situation& situation,
                     const shield::ShieldDecision& decision) const;
  static bool isOnGoal(const core::VehicleState& state, const Status& status);
  bool isParked(const Situation& situation, const Status& status);
  shield::Ego egoFor(core::Utime now, const Situation& situation, const core::Command& command,
                     const Status& status);
  void flyInstead(const shield::ShieldDecision& decision, const Situation& situation,
                  core::Command& command) const;
  shield::Neighbour neighbour(std::size_t vehicle, core::Utime now, const Track& track);
  shield::Neighbour neighbour(const SeenAgent& agent) const;
  void setIntent(const core::Command* said, const core::VehicleState& state,
                 const config::Vehicle& described, shield::Neighbour& other) const;
  void collectNeighbours(core::Utime now, const Situation& situation);
  const shield::Statics& statics(core::CommandMode mode, const Mapped& mapped,
                                 const shield::Ego& ego);

  const config::Experiment experiment_;
  const std::size_t own_index_;
  const bool on_;
  CommandBook book_;
  std::vector<shield::MotionBounds> bounds_;  // of each vehicle
  std::vector<shield::Observer> observers_;
  std::vector<shield::Neighbour> neighbours_;
  std::vector<core::Polygon> polygons_;
  std::vector<shield::Wall> walls_;       // as the body may touch them
  std::vector<shield::Wall> near_walls_;  // nearer by the margin: for positions in the room
  shield::Statics statics_;
  shield::Shield shield_;
  std::optional<core::Command> last_sent_;
  bool arrived_ = false;  // at this goal
  int interventions_ = 0;
};

}  // namespace roundabout::planner
