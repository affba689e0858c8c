#include "mocap_bridge/sources/natnet/writer.h"

namespace roundabout::mocap_bridge::natnet {

namespace {

using Writer = LittleEndianWriter;

constexpr std::size_t kNameBytes = 256;

void putSender(Writer& writer, const std::string& name,
               const std::array<std::uint8_t, 4>& application, Version version) {
  writer.putText(name, kNameBytes);
  for (const std::uint8_t part : application) {
    writer.put(part);
  }
  writer.put(static_cast<std::uint8_t>(version.major));
  writer.put(static_cast<std::uint8_t>(version.minor));
  writer.put<std::uint16_t>(0);
}

// The section's count, from 4.1 on its size, and its items.
template <class PutItems>
void putSection(Writer& writer, Version version, std::size_t count, PutItems put_items) {
  writer.put(static_cast<std::int32_t>(count));
  const std::size_t size_at = writer.size();
  if (version >= Version{4, 1}) {
    writer.put<std::uint32_t>(0);
  }
  const std::size_t begin = writer.size();
  put_items();
  if (version >= Version{4, 1}) {
    writer.set(size_at, static_cast<std::uint32_t>(writer.size() - begin));
  }
}

void putBody(Writer& writer, const RigidBody& body, Version version) {
  writer.put(body.id);
  for (const float value : body.position) {
    writer.put(value);
  }
  for (const float value : body.orientation_xyzw) {
    writer.put(value);
  }
  if (version < Version{3, 0}) {
    writer.put<std::int32_t>(0);  // markers
  }
  writer.put(body.mean_error_m);
  if (version >= Version{2, 6}) {
    writer.put(static_cast<std::uint16_t>(body.tracked ? 1 : 0));
  }
}

void putSuffix(Writer& writer, const Frame& frame, Version version) {
  if (version < Version{3, 0}) {
    writer.put(frame.software_latency_s);
  }
  writer.put(frame.timecode);
  writer.put(frame.timecode_subframe);
  if (version >= Version{2, 7}) {
    writer.put(frame.timestamp_s);
  } else if (version >= Version{2, 6}) {
    writer.put(static_cast<float>(frame.timestamp_s));
  }
  if (version >= Version{3, 0}) {
    writer.put(frame.mid_exposure_ticks);
    writer.put(frame.data_received_ticks);
    writer.put(frame.transmit_ticks);
  }
  if (version >= Version{4, 1}) {
    writer.put(frame.precision_s);
    writer.put(frame.precision_fraction);
  }
  if (version >= Version{2, 6}) {
    writer.put(frame.params);
  }
  writer.put<std::int32_t>(0);  // end tag
}

}  // namespace

Datagram writeMessage(MessageId id, Bytes payload) {
  Writer writer;
  writer.put(static_cast<std::uint16_t>(id));
  writer.put(static_cast<std::uint16_t>(payload.size()));
  writer.put(payload);
  return writer.bytes();
}

Datagram writeText(MessageId id, std::string_view text) {
  Writer payload;
  payload.putText(text);
  return writeMessage(id, payload.bytes());
}

Datagram writeConnect(const std::string& name, Version own_version) {
  Writer payload;
  putSender(payload, name, {1, 0, 0, 0}, own_version);
  return writeMessage(MessageId::kConnect, payload.bytes());
}

Datagram writeConnect(const std::string& name, Version own_version, Version wanted_bitstream) {
  Writer payload;
  putSender(payload, name, {1, 0, 0, 0}, own_version);
  payload.put<std::uint8_t>(0);  // all data, not only what was subscribed to
  payload.put(static_cast<std::uint8_t>(wanted_bitstream.major));
  payload.put(static_cast<std::uint8_t>(wanted_bitstream.minor));
  payload.put<std::uint16_t>(0);
  return writeMessage(MessageId::kConnect, payload.bytes());
}

Datagram writeServerInfo(const ServerInfo& info) {
  Writer payload;
  putSender(payload, info.name, info.application_version, info.version);
  if (info.version >= Version{3, 0}) {
    payload.put(info.tick_frequency_hz);
    payload.put(info.data_port);
    payload.put(static_cast<std::uint8_t>(info.multicast ? 1 : 0));
    for (int shift = 24; shift >= 0; shift -= 8) {
      payload.put(static_cast<std::uint8_t>(info.group >> shift));
    }
  }
  return writeMessage(MessageId::kServerInfo, payload.bytes());
}

Datagram writeEchoRequest(std::uint64_t client_stamp) {
  Writer payload;
  payload.put(client_stamp);
  return writeMessage(MessageId::kEchoRequest, payload.bytes());
}

Datagram writeEchoResponse(const EchoResponse& echo) {
  Writer payload;
  payload.put(echo.client_stamp);
  payload.put(echo.server_ticks);
  return writeMessage(MessageId::kEchoResponse, payload.bytes());
}

Datagram writeFrame(const Frame& frame, Version version) {
  Writer writer;
  const auto none = [] {};
  writer.put(frame.number);
  putSection(writer, version, 0, none);  // marker sets
  putSection(writer, version, 0, none);  // other markers
  putSection(writer, version, frame.bodies.size(), [&] {
    for (const RigidBody& body : frame.bodies) {
      putBody(writer, body, version);
    }
  });
  for (const Version since : {Version{2, 1}, Version{4, 1}, Version{2, 3}, Version{2, 9},
                              Version{2, 11}}) {  // skeletons to devices
    if (version >= since) {
      putSection(writer, version, 0, none);
    }
  }
  putSuffix(writer, frame, version);
  return writeMessage(MessageId::kFrame, writer.bytes());
}

Datagram writeModelDef(const ModelDef& definitions, Version version) {
  Writer writer;
  writer.put(static_cast<std::int32_t>(definitions.bodies.size()));
  for (const ModelDef::Body& body : definitions.bodies) {
    writer.put<std::int32_t>(1);
    const std::size_t size_at = writer.size();
    if (version >= Version{4, 1}) {
      writer.put<std::uint32_t>(0);
    }
    const std::size_t begin = writer.size();
    writer.putText(body.name);
    writer.put(body.id);
    writer.put<std::int32_t>(-1);
    for (int i = 0; i < 3; ++i) {
      writer.put(0.0F);
    }
    for (int i = 0; version >= Version{4, 2} && i < 4; ++i) {
      writer.put(i == 3 ? 1.0F : 0.0F);
    }
    if (version >= Version{3, 0}) {
      writer.put<std::int32_t>(0);
    }
    if (version >= Version{4, 1}) {
      writer.set(size_at, static_cast<std::uint32_t>(writer.size() - begin));
    }
  }
  return writeMessage(MessageId::kModelDef, writer.bytes());
}

}  // namespace roundabout::mocap_bridge::natnet
