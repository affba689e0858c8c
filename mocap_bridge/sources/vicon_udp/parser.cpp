#include "mocap_bridge/sources/vicon_udp/parser.h"

#include <algorithm>

namespace roundabout::mocap_bridge::vicon {

namespace {

constexpr std::size_t kNameBytes = 24;
constexpr std::uint16_t kObjectBytes = 72;
constexpr std::uint8_t kObjectItem = 0;

}  // namespace

const char* parseBlock(Bytes datagram, Block& block) {
  LittleEndianCursor cursor(datagram);
  block.frame = cursor.read<std::uint32_t>();
  const auto items = cursor.read<std::uint8_t>();
  block.objects.clear();
  for (int i = 0; i < items && !cursor.failed(); ++i) {
    const auto id = cursor.read<std::uint8_t>();
    LittleEndianCursor item(cursor.take(cursor.read<std::uint16_t>()));
    if (cursor.failed()) {
      break;
    }
    if (id != kObjectItem) {
      continue;
    }
    Object object;
    object.name = std::string(item.readText(kNameBytes));
    for (double& value : object.translation_mm) {
      value = item.read<double>();
    }
    for (double& value : object.rotation_rad) {
      value = item.read<double>();
    }
    if (item.failed()) {
      return "an object is shorter than 72 bytes";
    }
    block.objects.push_back(std::move(object));
  }
  if (cursor.failed()) {
    return "shorter than its items say";
  }
  const Bytes rest = cursor.take(cursor.remaining());
  const bool padding =
      std::all_of(rest.begin(), rest.end(), [](std::byte b) { return b == std::byte{0}; });
  return padding ? nullptr : "longer than its items say";
}

std::vector<std::byte> writeBlock(const Block& block) {
  LittleEndianWriter writer;
  writer.put(block.frame);
  writer.put(static_cast<std::uint8_t>(block.objects.size()));
  for (const Object& object : block.objects) {
    writer.put(kObjectItem);
    writer.put(kObjectBytes);
    writer.putText(object.name, kNameBytes);
    for (const double value : object.translation_mm) {
      writer.put(value);
    }
    for (const double value : object.rotation_rad) {
      writer.put(value);
    }
  }
  return writer.bytes();
}

}  // namespace roundabout::mocap_bridge::vicon
