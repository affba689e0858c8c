#include "mocap_bridge/sources/vicon_udp/session.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace roundabout::mocap_bridge::vicon {

namespace {

constexpr core::Utime kSilence = 2 * core::kMicrosPerSecond;

std::uint16_t portOf(const config::Mocap& mocap) {
  return mocap.data_port == 0 ? kDefaultPort : static_cast<std::uint16_t>(mocap.data_port);
}

}  // namespace

ViconSession::ViconSession(const config::Mocap& mocap)
    : named_(mocap.server.empty() ? kAnyAddress : resolveAddress("mocap.server", mocap.server)),
      server_(named_),
      // Bound to an interface's address, broadcasts would not be heard.
      socket_("Vicon object stream", {kAnyAddress, portOf(mocap)}, UdpSocket::Port::kAlone),
      interpreter_(mocap) {
  interfaceAddress("mocap.interface", mocap.interface);
}

void ViconSession::poll(core::Utime now, PacketSink& sink) {
  constexpr int kMost = 256;
  began_ = began_ == 0 ? now : began_;
  for (int i = 0; i < kMost; ++i) {
    const auto datagram = socket_.receive();
    if (!datagram) {
      break;
    }
    onDatagram(*datagram, arrivalTime(now), sink);
  }
  noteSilence(now);
}

void ViconSession::onDatagram(const UdpSocket::Received& datagram, core::Utime now,
                              PacketSink& sink) {
  if (server_ != kAnyAddress && datagram.from.address != server_) {
    ++wrong_sender_;
    notes_.once("wrong_sender",
                fmt::format("datagrams from {} are not looked at: the server is {} (mocap.server)",
                            addressText(datagram.from.address), addressText(server_)));
    return;
  }
  const Packet packet{now, datagram.from.port, socket_.port(), datagram.payload};
  if (tap_) {
    tap_(packet);
  }
  const std::int64_t malformed = interpreter_.counters().malformed;
  interpreter_.onPacket(packet, sink);
  if (interpreter_.counters().malformed > malformed) {
    notes_.once("malformed", "a datagram is no Vicon object block; further ones are counted");
    return;
  }
  if (server_ == kAnyAddress) {
    server_ = datagram.from.address;
    notes_.say("objects come from " + text(datagram.from));
  }
  notes_.over("silent", last_packet_ == 0 ? "objects arrive" : "objects arrive again");
  last_packet_ = now;
  connected_ = true;
}

void ViconSession::noteSilence(core::Utime now) {
  if (now - std::max(began_, last_packet_) >= kSilence) {
    connected_ = false;
    server_ = named_;
    notes_.once("silent",
                fmt::format("no object arrives on UDP port {} for 2 s; still listening. Is the UDP "
                            "Object Stream on in Tracker, and sent to this machine ({})? "
                            "(mocap.data_port, mocap.server)",
                            socket_.port(), interfaceList()));
  }
}

SourceStatus ViconSession::status() const {
  SourceStatus status;
  status.connected = connected_;
  status.server = "Vicon Tracker at " + addressText(server_);
  status.bodies = interpreter_.bodies();
  status.counters = interpreter_.counters();
  status.counters.wrong_sender = wrong_sender_;
  return status;
}

}  // namespace roundabout::mocap_bridge::vicon
