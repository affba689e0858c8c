#include "mocap_bridge/bridge_node.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

namespace roundabout::mocap_bridge {

namespace {

constexpr core::Utime kCheckSetUpAfter = 2 * core::kMicrosPerSecond;
// Longer than a flip, swap or jump needs to be known for one.
constexpr core::Utime kLostForLong = 1'200'000;
// Without a camera frame for so long there is nothing to predict from.
constexpr core::Utime kLongestPrediction = 100'000;
// No frame for so long: bodies were not lost, there was nothing to see them in.
constexpr core::Utime kOutage = core::kMicrosPerSecond / 2;
// Measurements may be a little outside the room.
constexpr double kRoomMargin_m = 1.0;
constexpr double kUpright = 0.7;
// Of the sum of two vehicles' radii: nearer, one would stand in the other.
constexpr double kWithin = 0.25;

std::vector<std::string> namesOf(const config::Experiment& experiment) {
  std::vector<std::string> names;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    names.push_back(vehicle.name);
  }
  return names;
}

bool inside(const config::Room& room, const Eigen::Vector3d& position_m) {
  return ((position_m - room.min_m).array() > -kRoomMargin_m).all() &&
         ((room.max_m - position_m).array() > -kRoomMargin_m).all();
}

}  // namespace

BridgeNode::BridgeNode(const config::Experiment& experiment, std::unique_ptr<Source> source,
                       const std::string& usual_axes, bus::Bus& bus)
    : room_(experiment.room),
      resampled_(experiment.mocap.output == "resampled"),
      period_us_(core::toUtime(1.0 / experiment.mocap.output_rate_hz)),
      source_(std::move(source)),
      estimator_(experiment, usual_axes),
      publisher_(bus, namesOf(experiment)) {
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    radii_m_.push_back(vehicle.body_radius_m);
  }
}

void BridgeNode::poll(core::Utime now) {
  source_->poll(now, *this);
  if (resampled_) {
    publishResampled(source_->dataTime(now));
  }
}

core::Utime BridgeNode::nextDeadline(core::Utime now) const {
  constexpr core::Utime kLongest = 20'000;
  const core::Utime left = last_tick_ + period_us_ - source_->dataTime(now);
  return now +
         (resampled_ && last_tick_ != 0 ? std::clamp<core::Utime>(left, 0, kLongest) : kLongest);
}

void BridgeNode::onFrame(const SourceFrame& frame) {
  const bool used = estimator_.update(frame);
  if (used && !resampled_) {
    publisher_.publish(estimator_.states());
  }
  if (frame.recorded && !used) {
    notes_.once(
        "recorded",
        "the system plays a recording back (Motive: Edit mode): not published as live. Go to "
        "Live, or set mocap.accept_recorded");
  } else {
    notes_.over("recorded", "the system is live again");
  }
  if (used) {
    const core::Utime now = frame.exposure_utime;
    first_frame_ = first_frame_ == 0 ? now : first_frame_;
    frames_since_ = std::abs(now - last_frame_) > kOutage ? now : frames_since_;
    last_frame_ = now;
    noteTracks(frame);
    noteSetUp(frame);
  }
}

void BridgeNode::publishResampled(core::Utime data_time) {
  const core::Utime tick = data_time / period_us_ * period_us_;
  const core::Utime exposure = estimator_.states().exposure_utime;
  if (tick == last_tick_ || exposure == 0) {
    return;
  }
  ticks_ += last_tick_ == 0 || tick < last_tick_ ? 1 : (tick - last_tick_) / period_us_;
  last_tick_ = tick;
  if (tick < exposure || tick - exposure > kLongestPrediction) {
    return;
  }
  core::StatesFrame states = estimator_.statesAt(tick);
  states.frame_number = ticks_;
  publisher_.publish(states);
}

void BridgeNode::noteTracks(const SourceFrame& frame) {
  for (std::size_t i = 0; i < estimator_.vehicles().size(); ++i) {
    const StateEstimator::Vehicle& vehicle = estimator_.vehicles()[i];
    const core::Utime last_seen = estimator_.states().vehicles[i].last_seen;
    const std::string lost = "lost " + vehicle.name;
    const std::string stuck = "stuck " + vehicle.name;
    if (vehicle.rival) {
      const StateEstimator::Vehicle& rival = estimator_.vehicles()[*vehicle.rival];
      if (*vehicle.rival > i) {
        notes_.once("shared " + vehicle.name,
                    fmt::format("{} and {} are mapped to one body ({} and {} are the same): "
                                "neither is believed (mocap.bodies)",
                                vehicle.name, rival.name, vehicle.body, rival.body));
      }
    } else if (vehicle.last == Verdict::kAccepted) {
      notes_.over("shared " + vehicle.name);
      const std::string again = vehicle.name + " is believed again";
      notes_.over(lost, notes_.over(stuck, again) ? std::string() : again);
    } else if (const auto fault = vehicle.tracker.stuckWith(frame.exposure_utime)) {
      notes_.once(
          stuck, *fault == Verdict::kFlip
                     ? fmt::format("{}: body {} has been seen the wrong way round for a second and "
                                   "is not believed. Are its markers too symmetric?",
                                   vehicle.name, vehicle.body)
                     : fmt::format("{}: body {} has been seen at another vehicle's place for a "
                                   "second and is not believed. Have two bodies been exchanged?",
                                   vehicle.name, vehicle.body));
    } else if (last_seen != 0 &&
               frame.exposure_utime - std::max(last_seen, frames_since_) > kLostForLong) {
      notes_.once(lost, fmt::format("{}: nothing of body {} could be used for more than a second; "
                                    "now it is {}",
                                    vehicle.name, vehicle.body, nameOf(vehicle.last)));
    }
  }
}

void BridgeNode::noteSetUp(const SourceFrame& frame) {
  if (set_up_checked_ || frame.exposure_utime - first_frame_ < kCheckSetUpAfter) {
    return;
  }
  set_up_checked_ = true;
  std::vector<std::string> streamed;
  for (const BodyPose& body : frame.bodies) {
    streamed.push_back(nameOf(body));
  }
  for (std::size_t i = 0; i < estimator_.vehicles().size(); ++i) {
    const StateEstimator::Vehicle& vehicle = estimator_.vehicles()[i];
    if (!vehicle.streamed) {
      notes_.say(fmt::format(
          "{}: the system streams no body {} (mocap.bodies); it streams {}", vehicle.name,
          vehicle.body, streamed.empty() ? "none" : fmt::format("{}", fmt::join(streamed, ", "))));
    } else if (!vehicle.rival) {
      notePose(i);
    }
  }
  noteDistances();
}

// A body that is streamed and was never believed.
void BridgeNode::noteUnused(const StateEstimator::Vehicle& vehicle) {
  std::size_t mostly = 1;
  for (std::size_t i = 1; i < kVerdicts; ++i) {
    const auto count = [&](std::size_t verdict) {
      return vehicle.tracker.count(static_cast<Verdict>(verdict));
    };
    mostly = count(i) > count(mostly) ? i : mostly;
  }
  const auto verdict = static_cast<Verdict>(mostly);
  const char* hint = verdict == Verdict::kAbsent ? ": does the system see its markers?"
                     : verdict == Verdict::kAcquiring
                         ? ": it moves farther from frame to frame than it can fly. Are its units "
                           "others (mocap.scale), or is it very noisy?"
                         : "";
  notes_.say(fmt::format("{}: nothing of body {} could be used in 2 s, mostly as {}{}",
                         vehicle.name, vehicle.body, nameOf(verdict), hint));
}

// What units and axes that are wrong look like.
void BridgeNode::notePose(std::size_t vehicle) {
  const core::VehicleState& state = estimator_.states().vehicles[vehicle];
  if (state.last_seen == 0) {
    noteUnused(estimator_.vehicles()[vehicle]);
    return;
  }
  const Eigen::Vector3d& at = state.position_world_m;
  const std::string where =
      fmt::format("{} is at ({:.2f}, {:.2f}, {:.2f})", state.name, at.x(), at.y(), at.z());
  if (!inside(room_, at)) {
    const bool millimetres = inside(room_, 0.001 * at) && at.norm() > 50.0;
    const bool other_up = inside(room_, {at.x(), at.z(), at.y()}) ||
                          inside(room_, {at.x(), -at.z(), at.y()}) ||
                          inside(room_, {at.x(), at.z(), -at.y()});
    notes_.say(where + ", outside the room" +
               (millimetres ? ": are its units millimetres? (mocap.scale: 0.001)"
                : other_up  ? ": is the other axis up? (mocap.axes: y_up or z_up)"
                            : " (room, mocap.axes, mocap.scale)"));
  }
  if ((state.orientation * Eigen::Vector3d::UnitZ()).z() < kUpright) {
    notes_.say(state.name +
               " does not stand upright: is the other axis up (mocap.axes), or was the body made "
               "while the vehicle was not level (mocap.bodies rotation_rad)?");
  }
}

// Once: wrong units bring all of them together.
void BridgeNode::noteDistances() {
  const std::vector<core::VehicleState>& states = estimator_.states().vehicles;
  for (std::size_t i = 0; i < states.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double apart_m = (states[i].position_world_m - states[j].position_world_m).norm();
      if (states[i].tracked && states[j].tracked &&
          apart_m < kWithin * (radii_m_[i] + radii_m_[j])) {
        notes_.say(
            fmt::format("{} and {} are {:.1f} cm apart, nearer than their bodies can be "
                        "(body_radius_m). Are units others than assumed (mocap.scale)?",
                        states[j].name, states[i].name, 100.0 * apart_m));
        return;
      }
    }
  }
}

std::vector<std::string> BridgeNode::takeNotes() {
  std::vector<std::string> notes = source_->takeNotes();
  for (std::string& note : notes_.take()) {
    notes.push_back(std::move(note));
  }
  return notes;
}

std::string BridgeNode::report() const {
  const SourceCounters counters = source_->status().counters;
  std::string text = fmt::format(
      "{} packets, {} frames, {} messages; not used: {} broken, {} of other machines, {} doubled "
      "or "
      "late, {} with impossible stamps, {} played back; {} lost, {} restarts",
      counters.packets, counters.frames, publisher_.counters().published, counters.malformed,
      counters.wrong_sender, counters.old_frames, counters.bad_stamps,
      estimator_.counters().recorded, counters.lost_frames, counters.restarts);
  for (const StateEstimator::Vehicle& vehicle : estimator_.vehicles()) {
    std::string refused;
    for (std::size_t i = 1; i < kVerdicts; ++i) {
      const auto verdict = static_cast<Verdict>(i);
      if (const std::int64_t count = vehicle.tracker.count(verdict); count > 0) {
        refused += fmt::format("{}{} {}", refused.empty() ? "" : ", ", count, nameOf(verdict));
      }
    }
    text += fmt::format("\n  {}: {} measurements taken{}", vehicle.name,
                        vehicle.tracker.count(Verdict::kAccepted),
                        refused.empty() ? "" : "; not: " + refused);
  }
  return text;
}

}  // namespace roundabout::mocap_bridge
