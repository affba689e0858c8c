#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "common/config/mapped_body.h"
#include "common/core/time.h"

namespace roundabout::mocap_bridge {

/// One rigid body as a motion-capture system sent it: in the axes of that system, in metres.
struct BodyPose {
  std::string name;      ///< empty while the system has not said
  std::int64_t id = -1;  ///< streaming id; -1: the protocol has none
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< body to the system's axes
  bool tracked = false;  ///< what the system says; true where it never says
  double residual_m = std::numeric_limits<double>::quiet_NaN();  ///< of the fit; NaN: not said
};

/// For people: "Hex_1", or "id 4" where the system says no name.
inline std::string nameOf(const BodyPose& body) {
  return config::bodyText(body.name, body.id);
}

/// A time stamp or counter of a frame as it stood in the packet.
struct FrameStamp {
  const char* name;
  double seconds = 0.0;     ///< for those in seconds
  std::uint64_t ticks = 0;  ///< for those in ticks, where is_ticks
  bool is_ticks = false;
};

/// One frame of a motion-capture system.
struct SourceFrame {
  std::int64_t number = 0;         ///< the system's, or counted where it has none
  core::Utime exposure_utime = 0;  ///< when the cameras looked, on this machine's clock
  core::Utime received_utime = 0;
  bool recorded = false;  ///< played back by the system: not what is in the room now
  std::vector<FrameStamp> stamps;
  std::vector<BodyPose> bodies;
};

/// What a packet was, for people.
struct PacketFacts {
  const char* kind = "";        ///< "server_info"
  const char* error = nullptr;  ///< why it could not be understood, or nullptr
  std::vector<std::pair<const char*, std::string>> facts;
};

/// Who takes what was understood. References are valid during the call.
class PacketSink {
 public:
  virtual ~PacketSink() = default;
  virtual void onFrame(const SourceFrame& frame) = 0;
  /// Of every packet that was no frame, or was broken.
  virtual void onPacket(const PacketFacts& /*facts*/) {}
};

}  // namespace roundabout::mocap_bridge
