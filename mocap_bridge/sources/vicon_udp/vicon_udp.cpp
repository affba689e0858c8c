#include <algorithm>

#include "mocap_bridge/sources/table.h"
#include "mocap_bridge/sources/vicon_udp/session.h"

namespace roundabout::mocap_bridge {

namespace {

/// Tracker with blocks of 1024 bytes.
class ViconEmulator final : public Emulator {
 public:
  explicit ViconEmulator(const EmulatorSettings& settings)
      : socket_("Vicon object stream", {resolveAddress("--address", settings.address), 0}),
        to_{resolveAddress("--to", settings.to),
            settings.data_port == 0 ? vicon::kDefaultPort
                                    : static_cast<std::uint16_t>(settings.data_port)} {}

  void poll(core::Utime /*now*/) override {}

  void send(const SourceFrame& frame, core::Utime /*now*/) override {
    constexpr std::size_t kObjectsInBlock = 13;
    for (std::size_t first = 0; first < frame.bodies.size(); first += kObjectsInBlock) {
      vicon::Block block;
      block.frame = static_cast<std::uint32_t>(frame.number);
      const std::size_t end = std::min(first + kObjectsInBlock, frame.bodies.size());
      for (std::size_t i = first; i < end; ++i) {
        block.objects.push_back(objectOf(frame.bodies[i]));
      }
      socket_.send(to_, vicon::writeBlock(block));
    }
  }

  void addDescriptors(std::vector<pollfd>&) const override {}
  int commandPort() const override { return to_.port; }

 private:
  static vicon::Object objectOf(const BodyPose& body) {
    vicon::Object object;
    object.name = body.name;
    if (body.tracked) {
      const Eigen::Matrix3d turned = body.orientation.normalized().toRotationMatrix();
      // R = Rx(a) Ry(b) Rz(c)
      object.rotation_rad = {std::atan2(-turned(1, 2), turned(2, 2)),
                             std::asin(std::clamp(turned(0, 2), -1.0, 1.0)),
                             std::atan2(-turned(0, 1), turned(0, 0))};
      Eigen::Map<Eigen::Vector3d>(object.translation_mm.data()) = 1000.0 * body.position_m;
    }
    return object;
  }

  UdpSocket socket_;
  Endpoint to_;
};

std::unique_ptr<Source> makeSession(const config::Mocap& mocap) {
  return std::make_unique<vicon::ViconSession>(mocap);
}

std::unique_ptr<Interpreter> makeInterpreter(const config::Mocap& mocap) {
  return std::make_unique<vicon::ViconInterpreter>(mocap);
}

std::unique_ptr<Emulator> makeEmulator(const EmulatorSettings& settings) {
  return std::make_unique<ViconEmulator>(settings);
}

}  // namespace

namespace vicon_udp {

Protocol protocol() { return {"vicon_udp", "z_up", 0, makeSession, makeInterpreter, makeEmulator}; }

}  // namespace vicon_udp

}  // namespace roundabout::mocap_bridge
