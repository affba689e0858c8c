#pragma once

// Recorded packets. Our own format, little-endian, one record after the other without a header:
// f64 time of arrival (s, Unix), u16 source port, u16 destination port, u32 bytes, payload.

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "mocap_bridge/sources/source.h"

namespace roundabout::mocap_bridge {

struct StoredPacket {
  core::Utime received = 0;  ///< us, clock of the machine that recorded; 0: not known
  std::uint16_t from_port = 0;
  std::uint16_t to_port = 0;
  std::vector<std::byte> payload;

  Packet view() const { return {received, from_port, to_port, payload}; }
};

struct PacketFile {
  std::vector<StoredPacket> packets;
  std::string damage;  ///< what the end lacks; empty: nothing
};

/// Reads records, a pcapng capture (UDP and TCP over IPv4, fragments put together again), or takes
/// the whole file for one packet. Throws core::StartupError if it cannot be read or is empty.
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
