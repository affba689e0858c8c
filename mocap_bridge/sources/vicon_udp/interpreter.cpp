#include "mocap_bridge/sources/vicon_udp/interpreter.h"

#include <algorithm>

#include "common/core/rotation.h"

namespace roundabout::mocap_bridge::vicon {

namespace {

constexpr double kMetres = 0.001;
// Names come off the wire: nobody can make us remember more.
constexpr std::size_t kMostBodies = 1024;

}  // namespace

RotationOrder rotationOrder(const std::string& name) {
  return name == "zyx"      ? RotationOrder::kZyx
         : name == "vector" ? RotationOrder::kVector
                            : RotationOrder::kXyz;
}

Eigen::Quaterniond toQuaternion(const std::array<double, 3>& rotation_rad, RotationOrder order) {
  const Eigen::Vector3d angles(rotation_rad.data());
  switch (order) {
    case RotationOrder::kXyz:
      return core::fromIntrinsicXyz(angles);
    case RotationOrder::kZyx:
      return core::fromRollPitchYaw(angles);
    case RotationOrder::kVector:
      break;
  }
  return core::fromRotationVector(angles);
}

ViconInterpreter::ViconInterpreter(const config::Mocap& mocap)
    : order_(rotationOrder(mocap.rotation)), rate_hz_(mocap.rate_hz), clock_(mocap.latency_s) {}

void ViconInterpreter::onPacket(const Packet& packet, PacketSink& sink) {
  ++counters_.packets;
  if (const char* reason = parseBlock(packet.payload, block_)) {
    ++counters_.malformed;
    sink.onPacket({"block", reason, {}});
    return;
  }
  if (auto unsent = assembler_.begin(block_.frame)) {
    emit(*unsent, sink);
  }
  SourceFrame& frame = assembler_.frame();
  if (frame.bodies.empty()) {
    frame.number = block_.frame;
    frame.received_utime = packet.received;
  }
  addBodies();
  if (showsEverything()) {
    sink.onFrame(frame);
  } else if (assembler_.complete()) {
    emit(frame, sink);
  }
}

void ViconInterpreter::addBodies() {
  std::vector<BodyPose>& bodies = assembler_.frame().bodies;
  for (Object& object : block_.objects) {
    // A block that comes twice, or of another frame with the same number.
    const bool twice = std::any_of(bodies.begin(), bodies.end(),
                                   [&](const BodyPose& body) { return body.name == object.name; });
    if (twice || bodies.size() >= kMostBodies) {
      ++counters_.old_frames;
      continue;
    }
    BodyPose& body = bodies.emplace_back();
    const Eigen::Vector3d translation_mm(object.translation_mm.data());
    body.position_m = kMetres * translation_mm;
    body.orientation = toQuaternion(object.rotation_rad, order_);
    body.tracked =
        !(translation_mm.isZero(0.0) && Eigen::Vector3d(object.rotation_rad.data()).isZero(0.0));
    body.name = std::move(object.name);
    if (names_.size() < kMostBodies) {
      names_.insert(body.name);
    }
  }
}

void ViconInterpreter::emit(const SourceFrame& frame, PacketSink& sink) {
  bool restarted = false;
  if (showsEverything() || !admits(frame.number, restarted)) {
    return;
  }
  if (restarted) {
    clock_.reset();
  }
  ExposureClock::Stamps stamps;
  if (rate_hz_ > 0.0) {
    stamps.sent_s = static_cast<double>(frame.number) / rate_hz_;
  }
  const auto exposure = clock_.exposureOf(stamps, frame.received_utime);
  if (!admits(exposure)) {
    return;
  }
  ++counters_.frames;
  SourceFrame out = frame;
  out.exposure_utime = *exposure;
  sink.onFrame(out);
}

}  // namespace roundabout::mocap_bridge::vicon
