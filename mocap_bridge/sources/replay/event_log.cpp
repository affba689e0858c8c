#include <cstdio>
#include <fstream>
#include <memory>

#include <lcm/eventlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "mocap_bridge/sources/replay/replay.h"

namespace roundabout::mocap_bridge {

namespace {

struct CloseLog {
  void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
};
struct FreeEvent {
  void operator()(lcm_eventlog_event_t* event) const { lcm_eventlog_free_event(event); }
};

SourceFrame toFrame(const core::StatesFrame& states) {
  SourceFrame frame;
  frame.number = states.frame_number;
  frame.exposure_utime = states.utime;
  frame.received_utime = states.utime;
  for (const core::VehicleState& state : states.vehicles) {
    BodyPose& body = frame.bodies.emplace_back();
    body.name = state.name;
    body.position_m = state.position_world_m;
    body.orientation = state.orientation;
    body.tracked = state.tracked;
  }
  return frame;
}

}  // namespace

bool looksLikeEventLog(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char sync[4] = {};
  file.read(reinterpret_cast<char*>(sync), sizeof(sync));
  return sync[0] == 0xed && sync[1] == 0xa1 && sync[2] == 0xda && sync[3] == 0x01;
}

std::vector<SourceFrame> readStatesOfLog(const std::string& path) {
  std::vector<SourceFrame> frames;
  const std::unique_ptr<lcm_eventlog_t, CloseLog> log(lcm_eventlog_create(path.c_str(), "r"));
  roundabout_msgs::vehicle_states_t message;
  core::StatesFrame states;
  while (log) {
    const std::unique_ptr<lcm_eventlog_event_t, FreeEvent> event(
        lcm_eventlog_read_next_event(log.get()));
    if (!event) {
      break;
    }
    const std::string_view channel(event->channel, static_cast<std::size_t>(event->channellen));
    const auto size = static_cast<std::size_t>(event->datalen);
    if (channel == bus::kStatesChannel &&
        bus::decode(std::as_bytes(std::span(static_cast<const char*>(event->data), size)),
                    message) == nullptr) {
      bus::fromMessage(message, states);
      frames.push_back(toFrame(states));
    }
  }
  return frames;
}

}  // namespace roundabout::mocap_bridge
