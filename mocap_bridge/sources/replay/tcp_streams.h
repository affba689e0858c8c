#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "mocap_bridge/sources/replay/packet_file.h"

namespace roundabout::mocap_bridge {

/// One captured TCP segment (RFC 9293).
struct TcpSegment {
  std::uint32_t from_address = 0;
  std::uint32_t to_address = 0;
  std::uint16_t from_port = 0;
  std::uint16_t to_port = 0;
  std::uint32_t sequence = 0;
  bool syn = false;
  bool ack = false;
  Bytes payload;
};

/// Captured segments to what servers said, connection by connection: in the order of the sequence
/// numbers, nothing twice. The server is who was connected to; of a connection whose beginning was
/// not captured, who has the lower port. What clients said is left out.
///
/// Where bytes never come, the stream goes on behind them once what follows has waited for a second
/// or is 1 MiB, or the capture is over.
class TcpStreams {
 public:
  void add(const TcpSegment& segment, core::Utime received, PacketFile& out);
  /// There is no more.
  void finish(PacketFile& out);

 private:
  struct Waiting {
    core::Utime received;
    std::vector<std::byte> payload;
  };
  struct Stream {
    int connection = 0;  // 0: nothing was said yet
    bool started = false;
    std::uint32_t next_sequence = 0;
    std::uint64_t next = 0;                    // the same, counted on
    std::map<std::uint64_t, Waiting> waiting;  // by the place of their first byte
    std::size_t waiting_bytes = 0;
    core::Utime latest = 0;
    std::uint16_t from_port = 0;
    std::uint16_t to_port = 0;
  };
  using Key = std::tuple<std::uint32_t, std::uint16_t, std::uint32_t, std::uint16_t>;

  void take(Stream& stream, const TcpSegment& segment, core::Utime received, PacketFile& out);
  void takeWaiting(Stream& stream, PacketFile& out);
  void giveUpGap(Stream& stream, PacketFile& out);
  void deliver(Stream& stream, std::uint64_t place, Bytes payload, core::Utime received,
               PacketFile& out);

  std::map<Key, Stream> streams_;  // by who speaks
  std::map<Key, bool> servers_;    // who does, where the connection's beginning says it
  int connections_ = 0;
};

}  // namespace roundabout::mocap_bridge
