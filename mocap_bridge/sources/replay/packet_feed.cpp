#include "mocap_bridge/sources/replay/packet_feed.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

namespace roundabout::mocap_bridge {

PacketFeed::PacketFeed(const Protocol& protocol, const config::Mocap& mocap, const PacketFile& file)
    : streams_(protocol.stream_port != 0),
      port_(mocap.command_port != 0 ? mocap.command_port : protocol.stream_port) {
  const auto from = [&](const StoredPacket& packet) {
    return packet.transport == Transport::kTcp && packet.from_port == port_;
  };
  if (mocap.command_port == 0 && std::none_of(file.packets.begin(), file.packets.end(), from)) {
    const auto stream = std::find_if(
        file.packets.begin(), file.packets.end(),
        [](const StoredPacket& packet) { return packet.transport == Transport::kTcp; });
    port_ = stream == file.packets.end() ? port_ : stream->from_port;
  }
}

bool PacketFeed::wants(const StoredPacket& packet) {
  const bool other = streams_ ? packet.transport == Transport::kUdp ||
                                    (packet.connection != 0 && packet.from_port != port_)
                              : packet.transport == Transport::kTcp;
  const bool old = !other && packet.connection != 0 && packet.connection < connection_;
  of_others_ += other ? 1 : 0;
  of_old_connections_ += old ? 1 : 0;
  return !other && !old;
}

void PacketFeed::feed(const StoredPacket& packet, Interpreter& interpreter, PacketSink& sink) {
  if (!wants(packet)) {
    return;
  }
  if (packet.connection > connection_ || (streams_ && packet.payload.empty())) {
    connection_ = packet.connection;
    interpreter.onConnection();
  }
  if (packet.after_gap) {
    ++gaps_;
    interpreter.onGap();
  }
  if (!streams_ || !packet.payload.empty()) {
    interpreter.onPacket(packet.view(), sink);
  }
}

std::string PacketFeed::remark() const {
  std::vector<std::string> left_out;
  if (gaps_ > 0) {
    left_out.push_back(
        fmt::format("{} gap(s) in the stream, where a capture lost segments", gaps_));
  }
  if (of_old_connections_ > 0) {
    left_out.push_back(
        fmt::format("{} segments of connections that a later one replaced were left "
                    "out",
                    of_old_connections_));
  }
  if (streams_ && of_others_ > 0) {
    left_out.push_back(
        fmt::format("{} packets not from TCP port {} were left out", of_others_, port_));
  }
  return fmt::format("{}", fmt::join(left_out, "; "));
}

}  // namespace roundabout::mocap_bridge
