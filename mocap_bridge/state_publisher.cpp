#include "mocap_bridge/state_publisher.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/bus/listen.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"

namespace roundabout::mocap_bridge {

namespace {

// Sources deliver rounded quaternions; farther from unit than this it is not rounding any more.
constexpr double kUnitTolerance = 0.01;
// No source is faster. Hz.
constexpr double kHighestRate = 1000.0;
// A source that counts from more than this at 1 kHz has run for 30 years: it is not counting.
constexpr std::int64_t kHighestFirstNumber = 1'000'000'000'000;

bool usable(const core::VehicleState& state) {
  return state.position_world_m.allFinite() && state.velocity_world_mps.allFinite() &&
         state.angular_velocity_body_radps.allFinite() &&
         std::abs(state.orientation.norm() - 1.0) <= kUnitTolerance;
}

}  // namespace

StatePublisher::StatePublisher(bus::Bus& bus, const std::vector<std::string>& vehicles,
                               std::string channel)
    : bus_(bus), channel_(std::move(channel)) {
  for (const std::string& name : vehicles) {
    out_.vehicles.emplace_back().name = name;
  }
}

bool StatePublisher::hasOurVehicles(const core::StatesFrame& frame) const {
  return std::equal(frame.vehicles.begin(), frame.vehicles.end(), out_.vehicles.begin(),
                    out_.vehicles.end(),
                    [](const auto& a, const auto& b) { return a.name == b.name; });
}

void StatePublisher::forget() {
  for (core::VehicleState& state : out_.vehicles) {
    core::VehicleState blank;
    blank.name = state.name;
    state = blank;
  }
}

std::int64_t StatePublisher::numberOf(const core::StatesFrame& frame) const {
  if (counters_.published == 0) {
    const bool counts = frame.frame_number >= 0 && frame.frame_number <= kHighestFirstNumber;
    return counts ? frame.frame_number : 0;
  }
  const bool grows = frame.frame_number > source_number_ && source_number_ >= 0;
  const double passed_s = core::toSeconds(frame.utime - out_.utime);
  const std::int64_t step = grows ? frame.frame_number - source_number_ : 1;
  return out_.frame_number +
         (static_cast<double>(step) <= passed_s * kHighestRate + 1.0 ? step : 1);
}

bool StatePublisher::publish(const core::StatesFrame& frame) {
  const core::FrameVerdict verdict =
      hasOurVehicles(frame) ? gate_.judge(frame.utime) : core::FrameVerdict::kRefused;
  if (verdict == core::FrameVerdict::kRefused) {
    ++counters_.dropped_frames;
    return false;
  }
  if (verdict == core::FrameVerdict::kNewEpoch) {
    forget();
  }
  out_.frame_number = numberOf(frame);
  out_.utime = frame.utime;
  const bool exposed_before = frame.exposure_utime > 0 && frame.exposure_utime <= frame.utime;
  out_.exposure_utime = exposed_before ? frame.exposure_utime : frame.utime;
  source_number_ = frame.frame_number;
  for (std::size_t i = 0; i < frame.vehicles.size(); ++i) {
    const core::VehicleState& in = frame.vehicles[i];
    core::VehicleState& out = out_.vehicles[i];
    const bool shown = in.tracked || (in.predicted && out.last_seen != 0);
    if (shown && usable(in)) {
      const core::Utime last_seen = in.tracked ? out_.exposure_utime : out.last_seen;
      out = in;
      out.orientation.normalize();
      out.predicted = !in.tracked;
      out.last_seen = last_seen;
    } else {
      counters_.rejected_states += shown ? 1 : 0;
      out.tracked = false;
      out.predicted = false;
    }
  }
  bus::publish(bus_, channel_, bus::toMessage(out_));
  ++counters_.published;
  return true;
}

bool somebodyElsePublishes(bus::Bus& listener, std::chrono::milliseconds duration) {
  return !bus::heardWithin(duration, listener, {bus::kStatesChannel}).empty();
}

void requireSolePublisher(bus::Bus& listener, const std::string& url,
                          std::chrono::milliseconds duration) {
  if (somebodyElsePublishes(listener, duration)) {
    throw core::StartupError("lcm_url", bus::kStatesChannel, "no other publisher",
                             std::string(bus::kStatesChannel) + " is already published on " + url);
  }
}

}  // namespace roundabout::mocap_bridge
