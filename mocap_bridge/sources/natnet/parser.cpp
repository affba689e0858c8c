#include "mocap_bridge/sources/natnet/parser.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

namespace roundabout::mocap_bridge::natnet {

namespace {

using Cursor = LittleEndianCursor;

constexpr std::size_t kVectorBytes = 12;
constexpr std::size_t kSenderBytes = 264;
constexpr std::size_t kNameBytes = 256;

constexpr bool hasSizes(Version version) { return version >= Version{4, 1}; }

std::size_t labeledMarkerBytes(Version version) {
  return version >= Version{3, 0} ? 26 : version >= Version{2, 6} ? 22 : 20;
}

// Without the markers that bodies carried before 3.0.
std::size_t leastBodyBytes(Version version) {
  return version >= Version{3, 0} ? 38 : version >= Version{2, 6} ? 42 : 40;
}

template <std::size_t kSize>
std::array<float, kSize> readFloats(Cursor& cursor) {
  std::array<float, kSize> values;
  for (float& value : values) {
    value = cursor.read<float>();
  }
  return values;
}

RigidBody readBody(Cursor& cursor, Version version) {
  constexpr std::size_t kMarkerBytes = kVectorBytes + 4 + 4;  // position, id, size
  RigidBody body;
  body.id = cursor.read<std::int32_t>();
  body.position = readFloats<3>(cursor);
  body.orientation_xyzw = readFloats<4>(cursor);
  if (version < Version{3, 0}) {
    cursor.skip(cursor.readCount(kMarkerBytes) * kMarkerBytes);
  }
  body.mean_error_m = cursor.read<float>();
  if (version >= Version{2, 6}) {
    body.tracked = (cursor.read<std::uint16_t>() & 1U) != 0;
  }
  return body;
}

enum class Items { kOfOneSize, kOfAnySize };

// One section of a frame: its count, from 4.1 on its size, its items. Items of a version newer than
// the known ones may be longer: where they are all of one size, the next begins where that says;
// others, of which only their number is kept, are left out.
template <class ReadItem>
int readSection(Cursor& cursor, Version version, Items items, std::size_t least_item_bytes,
                ReadItem read_item) {
  const auto claimed = cursor.read<std::int32_t>();
  const std::size_t bytes = hasSizes(version) ? cursor.read<std::uint32_t>() : cursor.remaining();
  if (claimed < 0 || bytes > cursor.remaining() ||
      static_cast<std::size_t>(claimed) > bytes / least_item_bytes) {
    cursor.fail();
    return 0;
  }
  const auto count = static_cast<std::size_t>(claimed);
  const std::size_t begin = cursor.position();
  const bool newer = version > kNewestKnown;
  if (newer && items == Items::kOfAnySize) {
    cursor.skip(bytes);
    return claimed;
  }
  const std::size_t stride = newer && count > 0 && bytes % count == 0 ? bytes / count : 0;
  const auto skip_to = [&](std::size_t position) {
    if (!cursor.failed() && position > cursor.position()) {
      cursor.skip(position - cursor.position());
    }
  };
  for (std::size_t i = 0; i < count && !cursor.failed(); ++i) {
    read_item();
    skip_to(begin + (i + 1) * stride);
  }
  if (newer) {
    skip_to(begin + bytes);
  }
  if (hasSizes(version) && cursor.position() != begin + bytes) {
    cursor.fail();
  }
  return claimed;
}

void readMarkerSets(Cursor& cursor, Version version, Frame& frame) {
  frame.marker_sets = readSection(cursor, version, Items::kOfAnySize, 1 + 4, [&] {
    cursor.readText();
    cursor.skip(cursor.readCount(kVectorBytes) * kVectorBytes);
  });
  frame.other_markers = readSection(cursor, version, Items::kOfOneSize, kVectorBytes,
                                    [&] { cursor.skip(kVectorBytes); });
}

void readBodies(Cursor& cursor, Version version, Frame& frame) {
  frame.bodies.clear();
  readSection(cursor, version, Items::kOfOneSize, leastBodyBytes(version),
              [&] { frame.bodies.push_back(readBody(cursor, version)); });
  if (version >= Version{2, 1}) {
    frame.skeletons = readSection(cursor, version, Items::kOfAnySize, 4 + 4, [&] {
      cursor.skip(4);
      const std::size_t bones = cursor.readCount(leastBodyBytes(version));
      for (std::size_t i = 0; i < bones && !cursor.failed(); ++i) {
        readBody(cursor, version);
      }
    });
  }
  if (version >= Version{4, 1}) {
    frame.assets = readSection(cursor, version, Items::kOfAnySize, 4 + 4 + 4, [&] {
      cursor.skip(4);
      cursor.skip(cursor.readCount(leastBodyBytes(version)) * leastBodyBytes(version));
      cursor.skip(cursor.readCount(labeledMarkerBytes(version)) * labeledMarkerBytes(version));
    });
  }
}

void readAnalog(Cursor& cursor) {
  cursor.skip(4);
  const std::size_t channels = cursor.readCount(4);
  for (std::size_t i = 0; i < channels && !cursor.failed(); ++i) {
    cursor.skip(cursor.readCount(4) * 4);
  }
}

void readOtherSections(Cursor& cursor, Version version, Frame& frame) {
  if (version >= Version{2, 3}) {
    const std::size_t bytes = labeledMarkerBytes(version);
    frame.labeled_markers =
        readSection(cursor, version, Items::kOfOneSize, bytes, [&] { cursor.skip(bytes); });
  }
  if (version >= Version{2, 9}) {
    frame.force_plates =
        readSection(cursor, version, Items::kOfAnySize, 4 + 4, [&] { readAnalog(cursor); });
  }
  if (version >= Version{2, 11}) {
    frame.devices =
        readSection(cursor, version, Items::kOfAnySize, 4 + 4, [&] { readAnalog(cursor); });
  }
}

void readSuffix(Cursor& cursor, Version version, Frame& frame) {
  if (version < Version{3, 0}) {
    frame.software_latency_s = cursor.read<float>();
  }
  frame.timecode = cursor.read<std::uint32_t>();
  frame.timecode_subframe = cursor.read<std::uint32_t>();
  if (version >= Version{2, 7}) {
    frame.timestamp_s = cursor.read<double>();
  } else if (version >= Version{2, 6}) {
    frame.timestamp_s = static_cast<double>(cursor.read<float>());
  }
  if (version >= Version{3, 0}) {
    frame.mid_exposure_ticks = cursor.read<std::uint64_t>();
    frame.data_received_ticks = cursor.read<std::uint64_t>();
    frame.transmit_ticks = cursor.read<std::uint64_t>();
  }
  if (version >= Version{4, 1}) {
    frame.precision_s = cursor.read<std::uint32_t>();
    frame.precision_fraction = cursor.read<std::uint32_t>();
  }
  if (version >= Version{2, 6}) {
    frame.params = cursor.read<std::uint16_t>();
  }
}

const char* verdict(const Cursor& cursor, Version version) {
  if (cursor.failed()) {
    return "shorter than its counts say";
  }
  return cursor.remaining() > 0 && version <= kNewestKnown ? "longer than its counts say" : nullptr;
}

void readBodyDefinition(Cursor& cursor, Version version, ModelDef* definitions) {
  const std::string_view name = cursor.readText();
  const auto id = cursor.read<std::int32_t>();
  cursor.skip(4 + kVectorBytes);  // parent, offset
  if (version >= Version{4, 2}) {
    cursor.skip(16);  // rotation of the offset
  }
  if (version >= Version{3, 0}) {
    const std::size_t markers = cursor.readCount(kVectorBytes + 4);
    cursor.skip(markers * (kVectorBytes + 4));
    for (std::size_t i = 0; version >= Version{4, 0} && i < markers && !cursor.failed(); ++i) {
      cursor.readText();
    }
  }
  if (definitions != nullptr && !cursor.failed()) {
    definitions->bodies.push_back({id, std::string(name)});
  }
}

void readTexts(Cursor& cursor) {
  const std::size_t count = cursor.readCount(1);
  for (std::size_t i = 0; i < count && !cursor.failed(); ++i) {
    cursor.readText();
  }
}

void readSkeletonDefinition(Cursor& cursor, Version version) {
  cursor.readText();
  cursor.skip(4);
  const std::size_t bones = cursor.readCount(1 + 4 + 4 + kVectorBytes);
  for (std::size_t i = 0; i < bones && !cursor.failed(); ++i) {
    readBodyDefinition(cursor, version, nullptr);
  }
}

void readForcePlateDefinition(Cursor& cursor) {
  cursor.skip(4);
  cursor.readText();
  cursor.skip(4 + 4 + kVectorBytes + 144 * 4 + 12 * 4 + 4 + 4);
  readTexts(cursor);
}

void readDeviceDefinition(Cursor& cursor) {
  cursor.skip(4);
  cursor.readText();
  cursor.readText();
  cursor.skip(4 + 4);
  readTexts(cursor);
}

void readAssetDefinition(Cursor& cursor, Version version) {
  cursor.readText();
  cursor.skip(4 + 4);
  const std::size_t bodies = cursor.readCount(1 + 4 + 4 + kVectorBytes);
  for (std::size_t i = 0; i < bodies && !cursor.failed(); ++i) {
    readBodyDefinition(cursor, version, nullptr);
  }
  const std::size_t markers = cursor.readCount(1 + 4 + kVectorBytes + 4 + 2);
  for (std::size_t i = 0; i < markers && !cursor.failed(); ++i) {
    cursor.readText();
    cursor.skip(4 + kVectorBytes + 4 + 2);
  }
}

/// False for a type that nobody has heard of.
bool readDefinition(Cursor& cursor, std::int32_t type, Version version, ModelDef& definitions) {
  switch (type) {
    case 0:
      cursor.readText();
      readTexts(cursor);
      return true;
    case 1:
      readBodyDefinition(cursor, version, &definitions);
      return true;
    case 2:
      readSkeletonDefinition(cursor, version);
      return true;
    case 3:
      readForcePlateDefinition(cursor);
      return true;
    case 4:
      readDeviceDefinition(cursor);
      return true;
    case 5:
      cursor.readText();
      cursor.skip(kVectorBytes + 16);
      return true;
    case 6:
      readAssetDefinition(cursor, version);
      return true;
    default:
      return false;
  }
}

const char* readSizedDefinition(Cursor& cursor, std::int32_t type, Version version,
                                ModelDef& definitions) {
  Cursor body(cursor.take(cursor.read<std::uint32_t>()));
  if (cursor.failed()) {
    return "shorter than its sizes say";
  }
  const bool known = readDefinition(body, type, version, definitions);
  if (known && body.failed()) {
    return "a definition is shorter than it should be";
  }
  const bool left_over = known && body.remaining() > 0 && version <= kNewestKnown;
  return left_over ? "a definition is longer than it should be" : nullptr;
}

// Versions between which packets differ, by their first.
struct Layout {
  Version version;
  std::string_view name;
};

constexpr std::array<Layout, 7> kFrameLayouts = {{{{2, 5}, "2.3 to 2.5"},
                                                  {{2, 6}, "2.6"},
                                                  {{2, 7}, "2.7 or 2.8"},
                                                  {{2, 9}, "2.9 or 2.10"},
                                                  {{2, 11}, "2.11"},
                                                  {{3, 0}, "3.0 to 4.0"},
                                                  {{4, 1}, "4.1 or 4.2"}}};
constexpr std::array<Layout, 5> kModelDefLayouts = {{{{2, 5}, "2.0 to 2.11"},
                                                     {{3, 0}, "3.0 or 3.1"},
                                                     {{4, 0}, "4.0"},
                                                     {{4, 1}, "4.1"},
                                                     {{4, 2}, "4.2"}}};

template <class Fits>
std::optional<std::string_view> onlyOneThatFits(std::span<const Layout> layouts, Fits fits) {
  std::optional<std::string_view> found;
  for (const Layout& layout : layouts) {
    if (fits(layout.version)) {
      if (found) {
        return std::nullopt;
      }
      found = layout.name;
    }
  }
  return found;
}

}  // namespace

std::string text(const Version& version) {
  return std::to_string(version.major) + "." + std::to_string(version.minor);
}

std::optional<Message> parseMessage(Bytes datagram) {
  Cursor cursor(datagram);
  const auto id = cursor.read<std::uint16_t>();
  cursor.skip(2);
  if (cursor.failed()) {
    return std::nullopt;
  }
  return Message{static_cast<MessageId>(id), datagram.subspan(kHeaderBytes)};
}

const char* parseServerInfo(Bytes payload, ServerInfo& info) {
  if (payload.size() < kSenderBytes) {
    return "shorter than a server's name and versions";
  }
  Cursor cursor(payload);
  info = ServerInfo();
  info.name = std::string(cursor.readText(kNameBytes));
  for (std::uint8_t& part : info.application_version) {
    part = cursor.read<std::uint8_t>();
  }
  info.version.major = cursor.read<std::uint8_t>();
  info.version.minor = cursor.read<std::uint8_t>();
  cursor.skip(2);
  if (info.version < kOldestKnown) {
    return "of a version before 2.0";
  }
  if (info.version.major < 3) {
    return nullptr;
  }
  info.tick_frequency_hz = cursor.read<std::uint64_t>();
  info.data_port = cursor.read<std::uint16_t>();
  info.multicast = cursor.read<std::uint8_t>() != 0;
  info.group = 0;
  for (int i = 0; i < 4; ++i) {
    info.group = (info.group << 8) | cursor.read<std::uint8_t>();
  }
  return cursor.failed() ? "shorter than version 3 says it is" : nullptr;
}

const char* parseFrame(Bytes payload, Version version, Frame& frame) {
  std::vector<RigidBody> bodies = std::move(frame.bodies);  // keeps its memory
  frame = Frame();
  frame.bodies = std::move(bodies);
  Cursor cursor(payload);
  frame.number = cursor.read<std::int32_t>();
  readMarkerSets(cursor, version, frame);
  readBodies(cursor, version, frame);
  readOtherSections(cursor, version, frame);
  readSuffix(cursor, version, frame);
  const auto end_tag = cursor.read<std::int32_t>();
  if (!cursor.failed() && end_tag != 0 && version <= kNewestKnown) {
    return "its end tag is not 0";
  }
  return verdict(cursor, version);
}

std::optional<std::string_view> onlyFrameLayoutOf(Bytes payload) {
  Frame frame;
  return onlyOneThatFits(kFrameLayouts, [&](Version version) {
    return parseFrame(payload, version, frame) == nullptr;
  });
}

std::optional<std::string_view> onlyModelDefLayoutOf(Bytes payload) {
  ModelDef definitions;
  return onlyOneThatFits(kModelDefLayouts, [&](Version version) {
    return parseModelDef(payload, version, definitions) == nullptr;
  });
}

const char* parseModelDef(Bytes payload, Version version, ModelDef& definitions) {
  definitions = ModelDef();
  Cursor cursor(payload);
  const std::size_t count = cursor.readCount(hasSizes(version) ? 8 : 4 + 1);
  for (std::size_t i = 0; i < count && !cursor.failed(); ++i) {
    const auto type = cursor.read<std::int32_t>();
    if (hasSizes(version)) {
      if (const char* reason = readSizedDefinition(cursor, type, version, definitions)) {
        return reason;
      }
    } else if (!readDefinition(cursor, type, version, definitions)) {
      return "a definition of an unknown type";
    }
    ++definitions.datasets;
  }
  return verdict(cursor, version);
}

const char* parseEchoResponse(Bytes payload, EchoResponse& echo) {
  Cursor cursor(payload);
  echo.client_stamp = cursor.read<std::uint64_t>();
  echo.server_ticks = cursor.read<std::uint64_t>();
  return cursor.failed() ? "shorter than two stamps" : nullptr;
}

std::optional<Version> parseBitstream(Bytes payload) {
  constexpr std::string_view kWord = "Bitstream,";
  const std::string_view text(reinterpret_cast<const char*>(payload.data()), payload.size());
  return text.starts_with(kWord) ? parseVersion(text.substr(kWord.size())) : std::nullopt;
}

std::optional<float> parseFloatResponse(Bytes payload) {
  return payload.size() == 4 ? std::optional(Cursor(payload).read<float>()) : std::nullopt;
}

std::optional<Version> parseVersion(std::string_view text) {
  Version version;
  const char* end = text.data() + text.size();
  const auto major = std::from_chars(text.data(), end, version.major);
  if (major.ec != std::errc() || major.ptr == end || *major.ptr != '.') {
    return std::nullopt;
  }
  const auto minor = std::from_chars(major.ptr + 1, end, version.minor);
  const bool ends = minor.ptr == end || *minor.ptr == '.' || *minor.ptr == '\0';
  if (minor.ec != std::errc() || !ends || version < kOldestKnown || version.major > 255) {
    return std::nullopt;
  }
  return version;
}

}  // namespace roundabout::mocap_bridge::natnet
