#pragma once

// The one publisher of VEHICLE_STATES. The bridge and the simulator both end here, so their traffic
// cannot differ.

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/messages.h"
#include "common/core/frame_gate.h"
#include "common/core/vehicle_state.h"

namespace roundabout::mocap_bridge {

/// Publishes frames and keeps the promises of lcmtypes/vehicle_states_t.lcm whatever it is given:
/// utime increases, but for a source that was started anew (core::FrameGate), frame_number always;
/// vehicles stand in the order of the experiment, numbers are finite, quaternions are unit,
/// last_seen is the exposure_utime of the last frame in which the vehicle was tracked, and a
/// vehicle that is not tracked shows what was predicted of it, else its last estimate (zeros before
/// the first).
///
/// Numbers begin with the source's and grow by what the source's grow by, so that frames which
/// were lost are missing in them; a step that the time between the frames does not allow counts as
/// one.
class StatePublisher {
 public:
  struct Counters {
    std::int64_t published = 0;
    std::int64_t dropped_frames = 0;   ///< utime old or corrupt, wrong vehicles
    std::int64_t rejected_states = 0;  ///< said to be tracked, but not finite or not a rotation
  };

  /// `vehicles`: names in the order of the experiment file.
  StatePublisher(bus::Bus& bus, const std::vector<std::string>& vehicles,
                 std::string channel = bus::kStatesChannel);

  /// Of a tracked or predicted vehicle everything but last_seen is used, of another one only the
  /// name. A rejected state goes out as not tracked. Returns false if the frame was dropped.
  bool publish(const core::StatesFrame& frame);

  /// What went out last.
  const core::StatesFrame& lastPublished() const { return out_; }
  const Counters& counters() const { return counters_; }

 private:
  bool hasOurVehicles(const core::StatesFrame& frame) const;
  void forget();
  std::int64_t numberOf(const core::StatesFrame& frame) const;

  bus::Bus& bus_;
  std::string channel_;
  core::FrameGate gate_;
  core::StatesFrame out_;
  std::int64_t source_number_ = 0;  // of the last published frame
  Counters counters_;
};

/// True if a VEHICLE_STATES message arrives within the duration (wall clock). The bus should be an
/// object made for this question: subscriptions last as long as their bus.
bool somebodyElsePublishes(bus::Bus& listener, std::chrono::milliseconds duration);

/// What every program that publishes states calls before its first frame. Throws core::StartupError
/// if somebodyElsePublishes; `url` is named in it.
void requireSolePublisher(bus::Bus& listener, const std::string& url,
                          std::chrono::milliseconds duration);

}  // namespace roundabout::mocap_bridge
