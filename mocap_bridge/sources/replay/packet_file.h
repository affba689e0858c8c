#pragma once

// Recorded packets. Our own format, little-endian, one record after the other without a header:
// f64 time of arrival (s, Unix), u16 source port, u16 destination port, u32 bytes, payload. Of
// protocols over TCP a payload is the next bytes of the stream, and one of no bytes says that a new
// connection begins.

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge {

enum class Transport : std::uint8_t { kUnknown, kUdp, kTcp };

struct StoredPacket {
  core::Utime received = 0;  ///< us, clock of the machine that recorded; 0: not known
  std::uint16_t from_port = 0;
  std::uint16_t to_port = 0;
  Transport transport = Transport::kUnknown;  ///< known of captures
  int connection = 0;                         ///< kTcp: counted from 1
  bool after_gap = false;                     ///< kTcp: bytes before it were not captured
  std::vector<std::byte> payload;

  Packet view() const { return {received, from_port, to_port, payload}; }
};

struct PacketFile {
  std::vector<StoredPacket> packets;
  std::string damage;     ///< what the end lacks; empty: nothing
  std::int64_t gaps = 0;  ///< in TCP streams
  std::int64_t missing_bytes = 0;
};

/// Reads records, a pcapng capture (UDP and TCP over IPv4, fragments and streams put together
/// again), or takes the whole file for one packet. Throws core::StartupError if it cannot be read
/// or is empty.
PacketFile readPacketFile(const std::string& path);
/// The same from bytes; `name` stands for the file in errors.
PacketFile parsePacketFile(Bytes bytes, const std::string& name);

/// Appends records.
class PacketWriter {
 public:
  /// Throws core::StartupError if the file cannot be made.
  explicit PacketWriter(const std::string& path);
  /// False if the disk is full or gone.
  bool write(const Packet& packet);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace roundabout::mocap_bridge
