#pragma once

#include "mocap_bridge/sources/replay/packet_file.h"

namespace roundabout::mocap_bridge {

bool looksLikePcapng(Bytes bytes);

/// UDP datagrams and what TCP servers said (TcpStreams), of a pcapng capture
/// (draft-ietf-opsawg-pcapng; Ethernet, Linux cooked or raw IP; IPv4). IP fragments are put
/// together; what is no such packet is left out. A capture that is cut off or broken ends where it
/// does, which `damage` says.
PacketFile readPcapng(Bytes bytes);

}  // namespace roundabout::mocap_bridge
