#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mocap_bridge/sources/byte_cursor.h"
#include "mocap_bridge/sources/byte_writer.h"

namespace roundabout::mocap_bridge::qualisys {

// QTM's real-time protocol 1.8 to 1.28 over TCP, little-endian port: packets of u32 size (with
// these eight bytes), u32 type, payload.

inline constexpr std::uint16_t kDefaultPort = 22223;
inline constexpr std::size_t kHeaderBytes = 8;
/// Settings of the largest systems are far smaller.
inline constexpr std::size_t kLongestPacket = 16U << 20;
inline constexpr int kNewestMinor = 28;
inline constexpr int kOldestMinor = 8;

enum class PacketType : std::uint32_t {
  kError = 0,
  kCommand = 1,
  kXml = 2,
  kData = 3,
  kNoMoreData = 4,
  kEvent = 6
};

enum class Component : std::uint32_t {
  k6D = 5,
  k6DEuler = 6,
  k6DResidual = 11,
  k6DEulerResidual = 12,
  kTimecode = 17
};

enum class Event : std::uint8_t {
  kConnected = 1,
  kCaptureStarted = 3,
  kRtFromFileStarted = 8,
  kRtFromFileStopped = 9,
  kWaitingForTrigger = 10,
  kCameraSettingsChanged = 11
};
/// True of what answers GetState: all others happen beside it.
inline bool isState(Event event) {
  return event >= Event::kConnected && event <= Event::kWaitingForTrigger;
}

struct Packet {
  PacketType type = PacketType::kError;
  Bytes payload;
};

struct Body {
  std::array<double, 3> position_mm{};
  std::array<double, 9> rotation{};  ///< column-major, body to world
  double residual_mm = 0.0;          ///< NaN: not in the packet
  bool tracked = false;              ///< untracked bodies are all NaN
};

struct Data {
  std::uint64_t timestamp_us = 0;  ///< since the capture began
  std::uint32_t frame = 0;         ///< may stand still in preview
  bool has_bodies = false;
  std::vector<Body> bodies;  ///< of the best component: rotation matrices before Euler angles
};

/// Takes the next whole packet off the front of `stream`. Nothing: it has not all arrived yet, or,
/// if `broken`, nothing behind what is there can be found.
std::optional<Packet> takePacket(Bytes& stream, bool& broken);

/// Returns nullptr, or why the payload is no data packet. Euler angles are taken as QTM's usual
/// ones, R = Rx Ry Rz, degrees.
const char* parseData(Bytes payload, Data& data);

/// Text of commands, answers and errors, without its NUL.
std::string parseText(Bytes payload);

/// Names of the bodies of <The_6D>, in the order in which data packets have them; nothing if the
/// text is no settings of QTM with bodies.
std::optional<std::vector<std::string>> parseBodyNames(Bytes payload);

std::vector<std::byte> writePacket(PacketType type, Bytes payload);
std::vector<std::byte> writeText(PacketType type, std::string_view text);
/// One component of bodies.
std::vector<std::byte> writeData(const Data& data, Component component);

}  // namespace roundabout::mocap_bridge::qualisys
