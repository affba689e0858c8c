#include "mocap_bridge/sources/replay/packet_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>

#include "common/core/error.h"
#include "mocap_bridge/sources/byte_writer.h"
#include "mocap_bridge/sources/replay/pcapng.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr std::size_t kRecordHeader = 16;
// Of plausible records: from 2001 to 2286.
constexpr double kEarliest_s = 1e9;
constexpr double kLatest_s = 1e10;
constexpr std::uint32_t kLargestPayload = 1 << 20;

// Nothing if the first record is none.
std::optional<PacketFile> readRecords(Bytes bytes) {
  PacketFile file;
  LittleEndianCursor cursor(bytes);
  while (cursor.remaining() > 0) {
    StoredPacket packet;
    const std::size_t at = cursor.position();
    const auto time_s = cursor.read<double>();
    packet.from_port = cursor.read<std::uint16_t>();
    packet.to_port = cursor.read<std::uint16_t>();
    const auto size = cursor.read<std::uint32_t>();
    const bool plausible =
        !cursor.failed() && time_s > kEarliest_s && time_s < kLatest_s && size <= kLargestPayload;
    if (!plausible || size > cursor.remaining()) {
      if (file.packets.empty()) {
        return std::nullopt;
      }
      file.damage = "no record at byte " + std::to_string(at);
      break;
    }
    packet.received = core::toUtime(time_s);
    const Bytes payload = cursor.take(size);
    packet.payload.assign(payload.begin(), payload.end());
    file.packets.push_back(std::move(packet));
  }
  return file;
}

}  // namespace

PacketFile parsePacketFile(Bytes bytes, const std::string& name) {
  if (bytes.empty()) {
    throw core::StartupError(name, "packets", "at least one byte", "an empty file");
  }
  if (looksLikePcapng(bytes)) {
    return readPcapng(bytes);
  }
  if (auto records = readRecords(bytes)) {
    return std::move(*records);
  }
  StoredPacket packet;
  packet.payload.assign(bytes.begin(), bytes.end());
  PacketFile file;
  file.packets.push_back(std::move(packet));
  return file;
}

PacketFile readPacketFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw core::StartupError(path, "packets", "a file that can be read", std::strerror(errno));
  }
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return parsePacketFile(bytesOf(text), path);
}

PacketWriter::PacketWriter(const std::string& path) : file_(std::fopen(path.c_str(), "wb")) {
  if (!file_) {
    throw core::StartupError(path, "packets", "a file that can be written", std::strerror(errno));
  }
}

bool PacketWriter::write(const Packet& packet) {
  LittleEndianWriter record;
  record.put(core::toSeconds(packet.received));
  record.put(packet.from_port);
  record.put(packet.to_port);
  record.put(static_cast<std::uint32_t>(packet.payload.size()));
  record.put(packet.payload);
  static_assert(kRecordHeader ==
                sizeof(double) + 2 * sizeof(std::uint16_t) + sizeof(std::uint32_t));
  return std::fwrite(record.bytes().data(), 1, record.size(), file_.get()) == record.size();
}

}  // namespace roundabout::mocap_bridge
