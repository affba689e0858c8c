#include <map>

#include "mocap_bridge/sources/sockets.h"
#include "mocap_bridge/sources/table.h"
#include "mocap_bridge/sources/vrpn/session.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr std::int32_t kPoseTypeId = 4;

/// A VRPN server with one tracker a body, TCP only.
class VrpnEmulator final : public Emulator {
 public:
  explicit VrpnEmulator(const EmulatorSettings& settings)
      : listener_("VRPN port", {resolveAddress("--address", settings.address),
                                settings.command_port == 0
                                    ? vrpn::kDefaultPort
                                    : static_cast<std::uint16_t>(settings.command_port)}) {}

  void poll(core::Utime /*now*/) override {
    while (auto stream = listener_.accept()) {
      stream->send(vrpn::writeCookie());
      clients_.push_back({std::move(stream), 0});
    }
    for (Client& client : clients_) {
      while (!client.stream->receive().empty()) {
      }
    }
    std::erase_if(clients_, [](const Client& client) { return client.stream->descriptor() < 0; });
  }

  void send(const SourceFrame& frame, core::Utime /*now*/) override {
    for (const BodyPose& body : frame.bodies) {
      if (!senders_.contains(body.name)) {
        const auto id = static_cast<std::int32_t>(senders_.size());
        senders_[body.name] = id;
        names_.push_back(body.name);
      }
    }
    for (Client& client : clients_) {
      describe(client);
      for (const BodyPose& body : frame.bodies) {
        if (body.tracked) {
          sendPose(*client.stream, frame.exposure_utime, body);
        }
      }
    }
  }

  void addDescriptors(std::vector<pollfd>& descriptors) const override {
    descriptors.push_back({listener_.descriptor(), POLLIN, 0});
    for (const Client& client : clients_) {
      descriptors.push_back({client.stream->descriptor(), POLLIN, 0});
    }
  }
  int commandPort() const override { return listener_.port(); }

 private:
  struct Client {
    std::unique_ptr<TcpStream> stream;
    std::size_t described = 0;
  };

  void describe(Client& client) {
    if (client.described == 0) {
      client.stream->send(
          vrpn::writeDescription(vrpn::kTypeDescription, kPoseTypeId, vrpn::kPoseType));
    }
    for (; client.described < names_.size(); ++client.described) {
      client.stream->send(vrpn::writeDescription(vrpn::kSenderDescription,
                                                 static_cast<std::int32_t>(client.described),
                                                 names_[client.described]));
    }
  }

  void sendPose(TcpStream& stream, core::Utime stamp, const BodyPose& body) {
    vrpn::Message header;
    header.seconds = static_cast<std::int32_t>(stamp / core::kMicrosPerSecond);
    header.microseconds = static_cast<std::int32_t>(stamp % core::kMicrosPerSecond);
    header.sender = senders_.at(body.name);
    header.type = kPoseTypeId;
    vrpn::Pose pose;
    Eigen::Map<Eigen::Vector3d>(pose.position_m.data()) = body.position_m;
    Eigen::Map<Eigen::Vector4d>(pose.orientation_xyzw.data()) = body.orientation.coeffs();
    stream.send(vrpn::writePose(header, pose));
  }

  TcpListener listener_;
  std::vector<Client> clients_;
  std::map<std::string, std::int32_t> senders_;
  std::vector<std::string> names_;
};

std::unique_ptr<Source> makeSession(const config::Mocap& mocap) {
  return std::make_unique<vrpn::VrpnSession>(mocap);
}

std::unique_ptr<Interpreter> makeInterpreter(const config::Mocap& mocap) {
  return std::make_unique<vrpn::VrpnInterpreter>(mocap);
}

std::unique_ptr<Emulator> makeEmulator(const EmulatorSettings& settings) {
  return std::make_unique<VrpnEmulator>(settings);
}

}  // namespace

namespace vrpn {

Protocol protocol() {
  return {"vrpn", "z_up", vrpn::kDefaultPort, makeSession, makeInterpreter, makeEmulator};
}

}  // namespace vrpn

}  // namespace roundabout::mocap_bridge
