#include "mocap_bridge/sources/vrpn/parser.h"

namespace roundabout::mocap_bridge::vrpn {

namespace {

std::size_t padded(std::size_t size) { return (size + 7) / 8 * 8; }

}  // namespace

bool goodCookie(Bytes cookie) {
  constexpr std::string_view kMajor = "vrpn: ver. 07.";
  const std::string_view text(reinterpret_cast<const char*>(cookie.data()), cookie.size());
  return text.starts_with(kMajor);
}

std::optional<Message> takeMessage(Bytes& stream, bool& broken) {
  BigEndianCursor cursor(stream);
  const auto length = cursor.read<std::int32_t>();
  Message message;
  message.seconds = cursor.read<std::int32_t>();
  message.microseconds = cursor.read<std::int32_t>();
  message.sender = cursor.read<std::int32_t>();
  message.type = cursor.read<std::int32_t>();
  cursor.skip(4);
  const bool long_enough = length >= static_cast<std::int32_t>(kHeaderBytes);
  broken =
      stream.size() >= 4 && (!long_enough || static_cast<std::size_t>(length) > kLongestMessage);
  if (broken || cursor.failed()) {
    return std::nullopt;
  }
  const std::size_t payload_bytes = static_cast<std::size_t>(length) - kHeaderBytes;
  if (cursor.remaining() < padded(payload_bytes)) {
    return std::nullopt;
  }
  message.payload = cursor.take(payload_bytes);
  stream = stream.subspan(kHeaderBytes + padded(payload_bytes));
  return message;
}

std::optional<std::string> parseDescription(Bytes payload) {
  BigEndianCursor cursor(payload);
  const std::size_t size = cursor.readCount(1);
  const std::string_view name = cursor.readText(size);
  return cursor.failed() || name.empty() ? std::nullopt : std::optional(std::string(name));
}

const char* parsePose(Bytes payload, Pose& pose) {
  BigEndianCursor cursor(payload);
  pose.sensor = cursor.read<std::int32_t>();
  cursor.skip(4);
  for (double& value : pose.position_m) {
    value = cursor.read<double>();
  }
  for (double& value : pose.orientation_xyzw) {
    value = cursor.read<double>();
  }
  if (cursor.failed()) {
    return "a pose is shorter than 64 bytes";
  }
  return cursor.remaining() > 0 ? "a pose is longer than 64 bytes" : nullptr;
}

std::vector<std::byte> writeCookie() {
  BigEndianWriter writer;
  writer.putText(kCookie, kCookieBytes);
  return writer.bytes();
}

std::vector<std::byte> writeMessage(const Message& message) {
  BigEndianWriter writer;
  writer.put(static_cast<std::int32_t>(kHeaderBytes + message.payload.size()));
  writer.put(message.seconds);
  writer.put(message.microseconds);
  writer.put(message.sender);
  writer.put(message.type);
  writer.put<std::int32_t>(0);
  writer.put(message.payload);
  writer.resize(padded(writer.size()));
  return writer.bytes();
}

std::vector<std::byte> writeDescription(std::int32_t type, std::int32_t id, std::string_view name) {
  BigEndianWriter payload;
  payload.put(static_cast<std::int32_t>(name.size() + 1));
  payload.putText(name);
  return writeMessage({0, 0, id, type, payload.bytes()});
}

std::vector<std::byte> writePose(const Message& header, const Pose& pose) {
  BigEndianWriter payload;
  payload.put(pose.sensor);
  payload.put<std::int32_t>(0);
  for (const double value : pose.position_m) {
    payload.put(value);
  }
  for (const double value : pose.orientation_xyzw) {
    payload.put(value);
  }
  Message message = header;
  message.payload = payload.bytes();
  return writeMessage(message);
}

}  // namespace roundabout::mocap_bridge::vrpn
