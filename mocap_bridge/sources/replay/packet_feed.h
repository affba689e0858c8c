#pragma once

#include <memory>
#include <string>

#include "mocap_bridge/sources/replay/packet_file.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

/// Gives an interpreter those packets of a file that are its protocol's. Of a capture these are
/// datagrams or streams, as the protocol is spoken over the one or the other. Streams are those of
/// the server's port, one at a time: a connection that begins to speak replaces the one before.
class PacketFeed {
 public:
  /// The port is `mocap`'s, else the protocol's, else that of the first stream in the file.
  PacketFeed(const Protocol& protocol, const config::Mocap& mocap, const PacketFile& file);

  void feed(const StoredPacket& packet, Interpreter& interpreter, PacketSink& sink);

  /// What was left out so far, for people; empty: nothing worth a word.
  std::string remark() const;

 private:
  bool wants(const StoredPacket& packet);

  const bool streams_;
  int port_ = 0;
  int connection_ = 0;
  std::int64_t of_others_ = 0;
  std::int64_t of_old_connections_ = 0;
  std::int64_t gaps_ = 0;
};

}  // namespace roundabout::mocap_bridge
