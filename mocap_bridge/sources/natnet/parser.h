#pragma once

#include <optional>

#include "mocap_bridge/sources/byte_cursor.h"
#include "mocap_bridge/sources/natnet/protocol.h"

namespace roundabout::mocap_bridge::natnet {

struct Message {
  MessageId id;
  Bytes payload;  ///< to the end of the datagram: the size in the header is only a hint
};

/// Nothing: shorter than a header.
std::optional<Message> parseMessage(Bytes datagram);

/// Each fills the struct and returns nullptr, or says in a few words why the payload is not what
/// that version sends; the struct then holds what was read so far. Known versions have to end
/// exactly where they should. Of a newer one, everything in front of its own additions is read, as
/// far as the section sizes of 4.1 allow.
const char* parseServerInfo(Bytes payload, ServerInfo& info);
const char* parseFrame(Bytes payload, Version version, Frame& frame);
const char* parseModelDef(Bytes payload, Version version, ModelDef& definitions);
/// The only bit streams ("2.7 or 2.8") as which the whole payload can be read; nothing: none or
/// several.
std::optional<std::string_view> onlyFrameLayoutOf(Bytes payload);
std::optional<std::string_view> onlyModelDefLayoutOf(Bytes payload);
const char* parseEchoResponse(Bytes payload, EchoResponse& echo);

/// "Bitstream,4.1.0.0", the answer to the request "Bitstream".
std::optional<Version> parseBitstream(Bytes payload);
/// An answer of four bytes as a number, as to "FrameRate".
std::optional<float> parseFloatResponse(Bytes payload);
/// "2.7"; nothing if it is none that is known.
std::optional<Version> parseVersion(std::string_view text);

}  // namespace roundabout::mocap_bridge::natnet
