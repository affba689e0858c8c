#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mocap_bridge/sources/byte_cursor.h"
#include "mocap_bridge/sources/byte_writer.h"

namespace roundabout::mocap_bridge::vrpn {

// VRPN 7 over one TCP connection: big-endian; first a cookie of 24 bytes from either side, then
// messages: i32 length without padding, i32 s, i32 us, i32 sender, i32 type, i32 sequence number,
// payload, padded to eight bytes.

inline constexpr std::uint16_t kDefaultPort = 3883;
inline constexpr std::size_t kCookieBytes = 24;
inline constexpr std::size_t kHeaderBytes = 24;
/// No message of a tracker is nearly as long.
inline constexpr std::size_t kLongestMessage = 1 << 16;
inline constexpr std::string_view kCookie = "vrpn: ver. 07.35  0";
inline constexpr std::string_view kPoseType = "vrpn_Tracker Pos_Quat";

// Types of the system; those of devices are positive and described by kTypeDescription.
inline constexpr std::int32_t kSenderDescription = -1;
inline constexpr std::int32_t kTypeDescription = -2;

struct Message {
  std::int32_t seconds = 0;
  std::int32_t microseconds = 0;
  std::int32_t sender = 0;
  std::int32_t type = 0;
  Bytes payload;
};

struct Pose {
  std::int32_t sensor = 0;
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation_xyzw{};
};

/// True if both sides speak version 7.
bool goodCookie(Bytes cookie);

/// Takes the next whole message off the front of `stream`. Nothing: it has not all arrived yet, or,
/// if `broken`, what is there is no message and nothing behind it can be found.
std::optional<Message> takeMessage(Bytes& stream, bool& broken);

/// The name that a description gives to its sender id; nothing if it is malformed.
std::optional<std::string> parseDescription(Bytes payload);
const char* parsePose(Bytes payload, Pose& pose);

std::vector<std::byte> writeCookie();
std::vector<std::byte> writeMessage(const Message& message);
std::vector<std::byte> writeDescription(std::int32_t type, std::int32_t id, std::string_view name);
std::vector<std::byte> writePose(const Message& header, const Pose& pose);

}  // namespace roundabout::mocap_bridge::vrpn
