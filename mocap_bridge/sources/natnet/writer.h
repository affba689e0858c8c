#pragma once

#include <vector>

#include "mocap_bridge/sources/byte_writer.h"
#include "mocap_bridge/sources/natnet/protocol.h"

namespace roundabout::mocap_bridge::natnet {

using Datagram = std::vector<std::byte>;

Datagram writeMessage(MessageId id, Bytes payload = {});
/// With `payload` as text and its NUL.
Datagram writeText(MessageId id, std::string_view text);
/// What a client says of itself; from 4.0 on with the bit stream that it wants (0.0: the newest).
Datagram writeConnect(const std::string& name, Version own_version);
Datagram writeConnect(const std::string& name, Version own_version, Version wanted_bitstream);
Datagram writeServerInfo(const ServerInfo& info);
Datagram writeEchoRequest(std::uint64_t client_stamp);
Datagram writeEchoResponse(const EchoResponse& echo);
/// Rigid bodies and the suffix; every other section is there and empty.
Datagram writeFrame(const Frame& frame, Version version);
Datagram writeModelDef(const ModelDef& definitions, Version version);

}  // namespace roundabout::mocap_bridge::natnet
