#pragma once

#include <set>

#include "mocap_bridge/sources/exposure_clock.h"
#include "mocap_bridge/sources/frame_assembler.h"
#include "mocap_bridge/sources/source.h"
#include "mocap_bridge/sources/vicon_udp/parser.h"

namespace roundabout::mocap_bridge::vicon {

/// How the three angles of an object are meant: R = Rx Ry Rz, R = Rz Ry Rx, or a rotation vector.
enum class RotationOrder { kXyz, kZyx, kVector };
RotationOrder rotationOrder(const std::string& name);
Eigen::Quaterniond toQuaternion(const std::array<double, 3>& rotation_rad, RotationOrder order);

/// The protocol has no stamps: exposures come from the frame numbers where the rate is known, else
/// from arrivals, minus the latency. An object that is all zeros is not seen.
class ViconInterpreter final : public Interpreter {
 public:
  explicit ViconInterpreter(const config::Mocap& mocap);

  void onPacket(const Packet& packet, PacketSink& sink) override;
  std::vector<std::string> bodies() const override { return {names_.begin(), names_.end()}; }

 private:
  void addBodies();
  void emit(const SourceFrame& frame, PacketSink& sink);

  RotationOrder order_;
  double rate_hz_;
  ExposureClock clock_;
  Block block_;
  FrameAssembler assembler_;
  std::set<std::string> names_;
};

}  // namespace roundabout::mocap_bridge::vicon
