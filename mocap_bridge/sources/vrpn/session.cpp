#include "mocap_bridge/sources/vrpn/session.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace roundabout::mocap_bridge::vrpn {

namespace {

constexpr core::Utime kSilence = 2 * core::kMicrosPerSecond;
// A connection that says nothing for so long may have lost its other end.
constexpr core::Utime kGiveUp = 5 * core::kMicrosPerSecond;

}  // namespace

VrpnSession::VrpnSession(const config::Mocap& mocap)
    : server_(serverOf(mocap, kDefaultPort)), interpreter_(mocap) {}

void VrpnSession::connect(core::Utime now) {
  if (stream_ || !reconnect_.due(now)) {
    return;
  }
  stream_ = std::make_unique<TcpStream>(server_);
  noteConnection();
  if (!stream_->failure().empty()) {
    notes_.once("socket", "no socket for VRPN: " + stream_->failure() + "; trying again");
  } else {
    notes_.over("socket");
  }
  cookie_sent_ = false;
  interpreter_.onConnection();
}

void VrpnSession::poll(core::Utime now, PacketSink& sink) {
  began_ = began_ == 0 ? now : began_;
  connect(now);
  if (stream_ && stream_->state() == TcpStream::State::kOpen) {
    if (!cookie_sent_) {
      cookie_sent_ = stream_->send(writeCookie());
    }
    receive(now, sink);
  }
  const core::Utime last = std::max({began_, last_packet_, reconnect_.last});
  const bool dead = stream_ && (stream_->state() == TcpStream::State::kClosed ||
                                interpreter_.broken() || now - last > kGiveUp);
  if (dead) {
    if (interpreter_.broken()) {
      notes_.once("broken", text(server_) + " does not speak VRPN 7; trying again");
    } else if (last_packet_ != 0) {
      notes_.once("lost", "the connection to " + text(server_) + " was lost; connecting again");
    }
    stream_.reset();
  }
  noteSilence(now);
}

void VrpnSession::receive(core::Utime now, PacketSink& sink) {
  for (Bytes bytes = stream_->receive(); !bytes.empty(); bytes = stream_->receive()) {
    const Packet packet{arrivalTime(now), server_.port, 0, bytes};
    tapStream(packet);
    const bool greeted = interpreter_.greeted();
    interpreter_.onPacket(packet, sink);
    if (!greeted && interpreter_.greeted()) {
      notes_.say("connected to " + text(server_) + ", " + interpreter_.greeting());
      notes_.over("lost");
      notes_.over("silent");
    }
    last_packet_ = now;
    notes_.over("silent", "the VRPN server is back");
    if (interpreter_.broken()) {
      return;
    }
  }
}

void VrpnSession::noteSilence(core::Utime now) {
  if (now - std::max(began_, last_packet_) >= kSilence) {
    notes_.once(
        "silent",
        fmt::format("nothing from a VRPN server at {} for 2 s; still trying. Is VRPN streaming "
                    "on there, and TCP port {} open in its firewall? (mocap.server; this "
                    "machine has {})",
                    text(server_), server_.port, interfaceList()));
  }
}

void VrpnSession::addDescriptors(std::vector<pollfd>& descriptors) const {
  if (stream_ && stream_->descriptor() >= 0) {
    const short events = stream_->connecting() ? POLLOUT : POLLIN;
    descriptors.push_back({stream_->descriptor(), events, 0});
  }
}

SourceStatus VrpnSession::status() const {
  SourceStatus status;
  status.connected = interpreter_.greeted();
  status.server = interpreter_.greeting() + " at " + text(server_);
  status.bodies = interpreter_.bodies();
  status.counters = interpreter_.counters();
  return status;
}

}  // namespace roundabout::mocap_bridge::vrpn
