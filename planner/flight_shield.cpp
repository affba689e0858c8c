#include "planner/flight_shield.h"

#include <algorithm>
#include <cmath>

#include "common/config/obstacles.h"
#include "common/core/angles.h"
#include "common/core/polygon.h"

namespace roundabout::planner {

namespace {

using core::CommandMode;
using core::ShieldLayer;
using Eigen::Vector2d;

// Slower than this, whoever is told to stay stands.
constexpr double kStands_mps = 0.1;
// Nearer it is on its goal, if it still moves.
constexpr double kOnGoal_m = 0.15;
// A heading is taken from a velocity that is faster than this.
constexpr double kDirected_mps = 0.05;
// What was said longer ago holds no more.
constexpr double kOldestWish_s = 0.5;

// Delay and lags may be this many times as long as the experiment file says.
constexpr double kReserve = 1.5;
// Of the acceleration that a multirotor's autopilot asks of its attitude loop.
constexpr double kMostJerk_mps3 = 30.0;

const config::MotionBounds& boundsOf(const config::Shield& shield, const config::Vehicle& vehicle) {
  return vehicle.model == "unicycle"       ? shield.unicycle
         : vehicle.model == "ground_robot" ? shield.ground_robot
                                           : shield.multirotor;
}

shield::MotionBounds motionBounds(const config::Shield& shield, const config::Vehicle& vehicle) {
  constexpr double kNeedNotTurn_radps = 1e6;
  const config::MotionBounds& bounds = boundsOf(shield, vehicle);
  shield::MotionBounds result;
  result.delay_s = bounds.delay_s;
  result.lag_s = bounds.lag_s;
  result.inner_lag_s = bounds.inner_lag_s;
  result.reserve = kReserve;
  if (vehicle.model == "multirotor") {
    result.max_jerk_mps3 = kMostJerk_mps3;
  }
  result.max_acceleration_mps2 = vehicle.max_acceleration_mps2;
  if (bounds.max_turn_rate_radps < kNeedNotTurn_radps) {
    result.max_turn_rate_radps = bounds.max_turn_rate_radps;
  }
  return result;
}

shield::ShieldParameters parametersOf(const config::Experiment& experiment, std::size_t own_index) {
  const config::Shield& settings = experiment.shield;
  const bool on = settings.on && experiment.vehicles[own_index].shielded;
  shield::ShieldParameters parameters = shield::ShieldParameters::lab();
  parameters.period_s = 1.0 / experiment.planner.rate_hz;
  parameters.hold_s = std::max(experiment.planner.command_valid_s, parameters.period_s);
  parameters.margin_m = settings.margin_m;
  parameters.unshielded_margin_m = settings.unshielded_margin_m;
  parameters.height_separation_m =
      settings.height_separation_m.value_or(std::numeric_limits<double>::infinity());
  parameters.look_ahead_s = on ? settings.look_ahead_s : 0.0;
  parameters.breaker = on && settings.breaker;
  parameters.steps_aside = on && settings.steps_aside;
  parameters.slow_down_distance_m = experiment.planner.slow_down_distance_m;
  parameters.step_aside_gain_per_s =
      boundsOf(settings, experiment.vehicles[own_index]).position_gain_per_s;
  parameters.suit(experiment.planner.policy.substr(0, experiment.planner.policy.find(':')));
  return parameters;
}

std::vector<shield::Wall> wallsOf(const config::Room& room, double farther_m) {
  return {{-Vector2d::UnitX(), -room.min_m.x() + farther_m},
          {Vector2d::UnitX(), room.max_m.x() + farther_m},
          {-Vector2d::UnitY(), -room.min_m.y() + farther_m},
          {Vector2d::UnitY(), room.max_m.y() + farther_m}};
}

bool moves(const core::Command& command) {
  return command.mode == CommandMode::kVelocity || command.mode == CommandMode::kPosition;
}

bool stands(const core::VehicleState& state) {
  return state.velocity_world_mps.head<2>().norm() < kStands_mps;
}

}  // namespace

FlightShield::FlightShield(const config::Experiment& experiment, std::size_t own_index)
    : experiment_(experiment),
      own_index_(own_index),
      on_(experiment.shield.on && experiment.vehicles[own_index].shielded),
      book_(experiment),
      polygons_(config::placesToAvoid(experiment)),
      walls_(wallsOf(experiment.room, 0.0)),
      near_walls_(wallsOf(experiment.room, experiment.shield.margin_m)),
      shield_(parametersOf(experiment, own_index)) {
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    bounds_.push_back(motionBounds(experiment.shield, vehicle));
    observers_.emplace_back(bounds_.back(), vehicle.shielded);
  }
  neighbours_.reserve(experiment.vehicles.size());
  statics_.obstacles = polygons_;
}

void FlightShield::beginAnew() {
  book_.clear();
  for (shield::Observer& observer : observers_) {
    observer.reset();
  }
  noteNewGoal();
  last_sent_.reset();
}

void FlightShield::noteNewGoal() {
  shield_.reset();
  arrived_ = false;
}

const char* FlightShield::onCommand(const core::Command& command, core::Utime newest_frame) {
  return book_.offer(command, newest_frame);
}

void FlightShield::observe(core::Utime now, const Situation& situation) {
  const TrackTable& tracks = situation.tracks();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Track& track = tracks.at(i);
    if (track.seen()) {
      const core::VehicleState& state = track.state();
      observers_[i].onState(core::toSeconds(now) - track.sinceAcceptedS(now),
                            state.position_world_m.head<2>(), state.velocity_world_mps.head<2>(),
                            core::headingOf(state.orientation));
    }
  }
  for (const CommandBook::Entry& entry : book_.apply(now)) {
    if (!experiment_.vehicles[entry.vehicle].shielded) {
      continue;  // something else may fly it
    }
    observers_[entry.vehicle].onCommand(
        core::toSeconds(entry.command.utime),
        velocityOf(entry.command, tracks.at(entry.vehicle), entry.vehicle),
        entry.command.valid_for_s);
  }
}

void FlightShield::noteSilence(core::Utime since, const Situation& situation) {
  core::Command hold;
  hold.utime = since;
  hold.valid_for_s = experiment_.planner.command_valid_s;
  onSent(hold, situation);
}

void FlightShield::onSent(const core::Command& command, const Situation& situation) {
  observers_[own_index_].onCommand(core::toSeconds(command.utime),
                                   velocityOf(command, situation.own(), own_index_),
                                   command.valid_for_s);
  last_sent_ = command;
}

/// How a vehicle sets off on a command; zero for those that stop it.
Vector2d FlightShield::velocityOf(const core::Command& command, const Track& track,
                                  std::size_t vehicle) const {
  const config::MotionBounds& bounds = boundsOf(experiment_.shield, experiment_.vehicles[vehicle]);
  Vector2d velocity = Vector2d::Zero();
  double fastest_mps = experiment_.vehicles[vehicle].top_speed_mps;
  if (command.mode == CommandMode::kVelocity) {
    velocity = command.velocity_world_mps.head<2>();
  } else if (command.mode == CommandMode::kPosition && track.seen()) {
    velocity = bounds.position_gain_per_s *
               (command.position_world_m - track.state().position_world_m).head<2>();
    fastest_mps = bounds.position_speed_mps;
  }
  const double speed_mps = velocity.norm();
  return speed_mps > fastest_mps ? Vector2d(velocity * (fastest_mps / speed_mps)) : velocity;
}

/// From where it is to where its command takes it; down to the floor for one that lands, or will by
/// itself.
void FlightShield::setHeights(const Track& track, const core::Command* in_force,
                              shield::Motion& motion) const {
  const double height_m = track.state().position_world_m.z();
  double other_m = height_m;
  if (in_force == nullptr || in_force->mode == CommandMode::kLand ||
      in_force->mode == CommandMode::kKill) {
    other_m = experiment_.room.min_m.z();
  } else if (moves(*in_force)) {
    other_m = in_force->position_world_m.z();
  }
  motion.lowest_m = std::min(height_m, other_m);
  motion.highest_m = std::max(height_m, other_m);
}

/// It is told to stay where it is.
bool FlightShield::holdsPlace(const core::Command& command, const core::VehicleState& state) const {
  return command.mode == CommandMode::kPosition &&
         (command.position_world_m - state.position_world_m).head<2>().norm() <
             experiment_.planner.hold_distance_m;
}

shield::Neighbour FlightShield::neighbour(std::size_t vehicle, core::Utime now,
                                          const Track& track) {
  const config::Vehicle& described = experiment_.vehicles[vehicle];
  const core::Command* const said = book_.latest(vehicle);
  const double said_s = said == nullptr ? 0.0 : core::toSeconds(now - said->utime);
  shield::Neighbour other;
  other.motion = observers_[vehicle].motion(core::toSeconds(now));
  setHeights(track, said != nullptr && said_s <= said->valid_for_s ? said : nullptr, other.motion);
  other.bounds = bounds_[vehicle];
  // What it may have done beside what it was told since it was seen.
  const double age_s = other.motion.age_s;
  other.radius_m =
      described.body_radius_m + std::min(described.top_speed_mps * age_s,
                                         0.5 * described.max_acceleration_mps2 * age_s * age_s);
  other.max_speed_mps = described.top_speed_mps;
  other.id = static_cast<int>(vehicle);
  other.shielded = described.shielded && age_s < experiment_.safety.own_track_hold_s;

  setIntent(said_s <= kOldestWish_s ? said : nullptr, track.state(), described, other);
  return other;
}

/// Somebody on the floor who is told nothing and says nothing: gets the whole gap, and more the
/// less is known of where it is.
shield::Neighbour FlightShield::neighbour(const SeenAgent& agent) const {
  shield::Neighbour other;
  other.motion.position_world_m = agent.measured_m;
  other.motion.velocity_world_mps = agent.velocity_mps;
  other.motion.lowest_m = experiment_.room.min_m.z();
  other.motion.highest_m = experiment_.room.max_m.z();
  other.motion.age_s = agent.age_s;
  other.radius_m = agent.radius_m + agent.uncertainty_m;
  other.max_speed_mps = std::max(agent.velocity_mps.norm(), experiment_.planner.standing_speed_mps);
  other.id = agent.id;
  other.shielded = false;
  other.parked = agent.stands;
  return other;
}

/// What it is going to do, by what it said: whoever is told nothing stays where it is.
void FlightShield::setIntent(const core::Command* said, const core::VehicleState& state,
                             const config::Vehicle& described, shield::Neighbour& other) const {
  const bool on_floor =
      config::flies(described) && state.position_world_m.z() - experiment_.room.min_m.z() <=
                                      experiment_.safety.airborne_height_m;
  if (said == nullptr) {
    other.parked = stands(state);
    return;
  }
  const bool holds_place = holdsPlace(*said, state);
  other.parked = stands(state) && (on_floor || holds_place || !moves(*said));
  other.gives_way = other.parked && holds_place && !on_floor && described.shielded &&
                    experiment_.shield.steps_aside;
  other.asks_for_way = said->asks_for_way;
  other.goal_world_m = said->goal_world_m;
}

void FlightShield::collectNeighbours(core::Utime now, const Situation& situation) {
  neighbours_.clear();
  if (!on_) {
    return;
  }
  const TrackTable& tracks = situation.tracks();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (situation.knowsOf(i)) {
      neighbours_.push_back(neighbour(i, now, tracks.at(i)));
    }
  }
  for (const SeenAgent& agent : situation.seen().agents()) {
    if (!situation.isKnown(agent, now)) {
      neighbours_.push_back(neighbour(agent));
    }
  }
}

/// Position control may bring the body up to a wall, less the margin: positions are in the room,
/// and the goal was chosen there. Of the margin to what is on the map it gives up what the goal
/// needs.
const shield::Statics& FlightShield::statics(CommandMode mode, const Mapped& mapped,
                                             const shield::Ego& ego) {
  const bool at_goal = mode == CommandMode::kPosition;
  statics_.walls = at_goal ? near_walls_ : walls_;
  statics_.mapped = mapped.pieces;
  statics_.mapped_slack_m = 0.0;
  if (at_goal) {
    const double margin_m = experiment_.shield.margin_m;
    for (const core::Polygon& piece : mapped.pieces) {
      const double left_m = core::distanceTo(piece, ego.goal_world_m) - ego.radius_m;
      statics_.mapped_slack_m =
          std::max(statics_.mapped_slack_m, std::clamp(margin_m - left_m, 0.0, margin_m));
    }
  }
  return statics_;
}

void FlightShield::guard(core::Utime now, const Situation& situation, const Mapped& mapped,
                         core::Command& command, Status& status) {
  status.shield.interventions = interventions_;
  if (!moves(command)) {
    return;
  }
  collectNeighbours(now, situation);
  shield::Ego ego = egoFor(now, situation, command, status);
  command.goal_world_m = ego.goal_world_m;
  ego.goal_world_m = mapped.next_place_m.value_or(ego.goal_world_m);
  ego.goal_is_final = ego.goal_world_m == command.goal_world_m;
  const Vector2d wanted = velocityOf(command, situation.own(), own_index_);
  shield::ShieldDecision decision = shield_.decide(
      ego, neighbours_, statics(command.mode, mapped, ego), wanted, core::toSeconds(now));
  const bool as_wanted = decision.layer == ShieldLayer::kNone;
  if (wouldSurprise(as_wanted && holdsPlace(command, situation.own().state()), situation,
                    decision)) {
    decision.velocity_world_mps.setZero();
    decision.layer = as_wanted ? ShieldLayer::kHard : decision.layer;
  }
  command.asks_for_way = decision.asks_for_way;
  if (decision.layer != ShieldLayer::kNone) {
    flyInstead(decision, situation, command);
    if (decision.layer == ShieldLayer::kStatic && status.reason.empty()) {
      status.reason =
          "slowed down at the edge of the room, an obstacle, a no-fly zone or something on the map";
    }
  }
  if (on_) {
    interventions_ += decision.layer == ShieldLayer::kNone ? 0 : 1;
    status.shield = {decision.layer, wanted, decision.velocity_world_mps, decision.predicted_gap_m,
                     interventions_};
  }
}

/// Others near it take it for parked, and use the whole gap: before it moves it says that it will.
bool FlightShield::wouldSurprise(bool stays, const Situation& situation,
                                 const shield::ShieldDecision& decision) const {
  const core::VehicleState& state = situation.own().state();
  return !stays && std::isfinite(decision.predicted_gap_m) && stands(state) && last_sent_ &&
         (!moves(*last_sent_) || holdsPlace(*last_sent_, state));
}

bool FlightShield::isOnGoal(const core::VehicleState& state, const Status& status) {
  return stands(state) || !status.goal ||
         (status.goal->position_world_m - state.position_world_m).head<2>().norm() <= kOnGoal_m;
}

/// It is where it shall be, or was until somebody asked for the way. Only who hovers steps aside.
bool FlightShield::isParked(const Situation& situation, const Status& status) {
  const Mode mode = status.mode;
  arrived_ = arrived_ || (mode == Mode::kAtGoal && isOnGoal(situation.own().state(), status));
  const bool may_step_aside =
      arrived_ && (situation.inTheAir() || !config::flies(situation.vehicle()));
  bool asked = false;
  for (shield::Neighbour& each : neighbours_) {
    each.asks_for_way = each.asks_for_way && may_step_aside;
    asked = asked || each.asks_for_way;
  }
  return mode == Mode::kAtGoal || mode == Mode::kTakingOff || asked;
}

shield::Ego FlightShield::egoFor(core::Utime now, const Situation& situation,
                                 const core::Command& command, const Status& status) {
  const config::Vehicle& vehicle = situation.vehicle();
  const core::VehicleState& state = situation.own().state();
  shield::Ego ego;
  ego.motion = observers_[own_index_].motion(core::toSeconds(now));
  setHeights(situation.own(), &command, ego.motion);
  ego.bounds = bounds_[own_index_];
  ego.radius_m = vehicle.body_radius_m;
  ego.goal_world_m = status.goal ? Vector2d(status.goal->position_world_m.head<2>())
                                 : Vector2d(state.position_world_m.head<2>());
  ego.preferred_speed_mps = vehicle.preferred_speed_mps;
  ego.max_speed_mps = vehicle.preferred_speed_mps;
  ego.id = static_cast<int>(own_index_);
  ego.parked = isParked(situation, status);
  return ego;
}

void FlightShield::flyInstead(const shield::ShieldDecision& decision, const Situation& situation,
                              core::Command& command) const {
  const Vector2d& velocity_mps = decision.velocity_world_mps;
  if (decision.predicted_gap_m < 0.0) {
    // Above or below somebody: it must not come to the same height.
    command.position_world_m.z() = situation.own().state().position_world_m.z();
  }
  command.mode = CommandMode::kVelocity;
  command.velocity_world_mps << velocity_mps, 0.0;
  if (velocity_mps.norm() > kDirected_mps) {
    const double heading_rad = std::atan2(velocity_mps.y(), velocity_mps.x());
    const double change_rad =
        core::wrapToPi(heading_rad - core::headingOf(situation.own().state().orientation));
    command.heading_world_rad = heading_rad;
    command.heading_rate_radps = experiment_.planner.heading_gain_per_s * change_rad;
  }
}

}  // namespace roundabout::planner
