#include "mocap_bridge/sources/replay/tcp_streams.h"

#include <algorithm>

namespace roundabout::mocap_bridge {

namespace {

constexpr std::size_t kMostWaiting = 1 << 20;
constexpr core::Utime kLongestWait = core::kMicrosPerSecond;

}  // namespace

void TcpStreams::add(const TcpSegment& segment, core::Utime received, PacketFile& out) {
  const Key key{segment.from_address, segment.from_port, segment.to_address, segment.to_port};
  const Key back{segment.to_address, segment.to_port, segment.from_address, segment.from_port};
  if (segment.syn) {
    servers_[key] = segment.ack;
    servers_[back] = !segment.ack;
  }
  const auto known = servers_.find(key);
  const bool from_server =
      known != servers_.end() ? known->second : segment.from_port < segment.to_port;
  Stream& stream = streams_[key];
  if (segment.syn && (!stream.started || segment.sequence + 1 != stream.next_sequence)) {
    while (!stream.waiting.empty()) {
      giveUpGap(stream, out);
    }
    stream = Stream();
    stream.started = true;
    stream.next_sequence = segment.sequence + 1;
  }
  stream.from_port = segment.from_port;
  stream.to_port = segment.to_port;
  if (from_server && !segment.payload.empty()) {
    take(stream, segment, received, out);
  }
}

void TcpStreams::take(Stream& stream, const TcpSegment& segment, core::Utime received,
                      PacketFile& out) {
  const std::uint32_t sequence = segment.sequence + (segment.syn ? 1U : 0U);
  if (!stream.started) {
    stream.started = true;
    stream.next_sequence = sequence;
  }
  const auto ahead = static_cast<std::int32_t>(sequence - stream.next_sequence);
  if (ahead <= 0) {
    const auto again = static_cast<std::size_t>(-std::int64_t{ahead});
    if (again < segment.payload.size()) {
      deliver(stream, stream.next, segment.payload.subspan(again), received, out);
    }
  } else {
    Waiting& waiting = stream.waiting[stream.next + static_cast<std::uint64_t>(ahead)];
    if (waiting.payload.size() < segment.payload.size()) {
      stream.waiting_bytes += segment.payload.size() - waiting.payload.size();
      waiting = {received, {segment.payload.begin(), segment.payload.end()}};
    }
  }
  takeWaiting(stream, out);
  while (!stream.waiting.empty() &&
         (stream.waiting_bytes > kMostWaiting ||
          received - stream.waiting.begin()->second.received > kLongestWait)) {
    giveUpGap(stream, out);
  }
}

void TcpStreams::takeWaiting(Stream& stream, PacketFile& out) {
  while (!stream.waiting.empty() && stream.waiting.begin()->first <= stream.next) {
    auto first = stream.waiting.extract(stream.waiting.begin());
    const std::vector<std::byte>& payload = first.mapped().payload;
    stream.waiting_bytes -= payload.size();
    const std::uint64_t again = stream.next - first.key();
    if (again < payload.size()) {
      deliver(stream, stream.next, Bytes(payload).subspan(again), first.mapped().received, out);
    }
  }
}

void TcpStreams::giveUpGap(Stream& stream, PacketFile& out) {
  const std::uint64_t place = stream.waiting.begin()->first;
  ++out.gaps;
  out.missing_bytes += static_cast<std::int64_t>(place - stream.next);
  stream.next_sequence += static_cast<std::uint32_t>(place - stream.next);
  auto first = stream.waiting.extract(stream.waiting.begin());
  stream.waiting_bytes -= first.mapped().payload.size();
  deliver(stream, place, first.mapped().payload, first.mapped().received, out);
  takeWaiting(stream, out);
}

void TcpStreams::deliver(Stream& stream, std::uint64_t place, Bytes payload, core::Utime received,
                         PacketFile& out) {
  stream.connection = stream.connection == 0 ? ++connections_ : stream.connection;
  stream.latest = std::max(stream.latest, received);
  StoredPacket packet;
  packet.received = stream.latest;
  packet.transport = Transport::kTcp;
  packet.from_port = stream.from_port;
  packet.to_port = stream.to_port;
  packet.connection = stream.connection;
  packet.after_gap = place > stream.next;
  packet.payload.assign(payload.begin(), payload.end());
  stream.next = place + payload.size();
  stream.next_sequence += static_cast<std::uint32_t>(payload.size());
  out.packets.push_back(std::move(packet));
}

void TcpStreams::finish(PacketFile& out) {
  for (auto& [key, stream] : streams_) {
    while (!stream.waiting.empty()) {
      giveUpGap(stream, out);
    }
  }
}

}  // namespace roundabout::mocap_bridge
