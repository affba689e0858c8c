#pragma once

// What OptiTrack's Motive says on the wire (NatNet 2.0 to 4.2), as plain structs. Little-endian
// datagrams: u16 message id, u16 payload bytes, payload. docs/mocap.md has the layouts.

#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace roundabout::mocap_bridge::natnet {

/// Of the bit stream; Motive's own version is another number.
struct Version {
  int major = 0;
  int minor = 0;
  auto operator<=>(const Version&) const = default;
};

inline constexpr Version kOldestKnown{2, 0};
inline constexpr Version kNewestKnown{4, 2};

std::string text(const Version& version);

enum class MessageId : std::uint16_t {
  kConnect = 0,
  kServerInfo = 1,
  kRequest = 2,
  kResponse = 3,
  kRequestModelDef = 4,
  kModelDef = 5,
  kRequestFrame = 6,
  kFrame = 7,
  kMessageString = 8,
  kDisconnect = 9,
  kKeepAlive = 10,
  kDisconnectByTimeout = 11,
  kEchoRequest = 12,
  kEchoResponse = 13,
  kDiscovery = 14,
  kUnrecognizedRequest = 100
};

inline constexpr std::size_t kHeaderBytes = 4;
inline constexpr std::uint16_t kDefaultCommandPort = 1510;
inline constexpr std::uint16_t kDefaultDataPort = 1511;
inline constexpr std::uint32_t kDefaultGroup = 0xefff2a63;  // 239.255.42.99

struct ServerInfo {
  std::string name;
  std::array<std::uint8_t, 4> application_version{};
  Version version;
  std::uint64_t tick_frequency_hz = 0;  ///< 0: before 3.0 the server does not say
  std::uint16_t data_port = kDefaultDataPort;
  bool multicast = true;
  std::uint32_t group = kDefaultGroup;
};

struct RigidBody {
  std::int32_t id = 0;
  std::array<float, 3> position{};          ///< m, axes as Motive streams them
  std::array<float, 4> orientation_xyzw{};  ///< body to those axes
  float mean_error_m = 0.0F;                ///< of the markers
  bool tracked = true;                      ///< before 2.6 the protocol does not say: true
};

struct Frame {
  // Bits of params.
  static constexpr std::uint16_t kRecording = 1;
  static constexpr std::uint16_t kModelListChanged = 2;
  static constexpr std::uint16_t kEditMode = 4;
  static constexpr std::uint16_t kBitstreamChanged = 8;

  std::int32_t number = 0;
  std::vector<RigidBody> bodies;
  int marker_sets = 0;
  int other_markers = 0;
  int skeletons = 0;
  int assets = 0;
  int labeled_markers = 0;
  int force_plates = 0;
  int devices = 0;
  float software_latency_s = std::numeric_limits<float>::quiet_NaN();  ///< before 3.0
  std::uint32_t timecode = 0;
  std::uint32_t timecode_subframe = 0;
  double timestamp_s = std::numeric_limits<double>::quiet_NaN();  ///< from 2.6
  std::uint64_t mid_exposure_ticks = 0;                           ///< from 3.0; 0: unknown
  std::uint64_t data_received_ticks = 0;
  std::uint64_t transmit_ticks = 0;
  std::uint32_t precision_s = 0;  ///< from 4.1, of PTP
  std::uint32_t precision_fraction = 0;
  std::uint16_t params = 0;  ///< from 2.6

  bool has(std::uint16_t param) const { return (params & param) != 0; }
};

/// Names of what is streamed; only rigid bodies are kept.
struct ModelDef {
  struct Body {
    std::int32_t id = 0;
    std::string name;
  };
  std::vector<Body> bodies;
  int datasets = 0;
};

struct EchoResponse {
  std::uint64_t client_stamp = 0;
  std::uint64_t server_ticks = 0;
};

}  // namespace roundabout::mocap_bridge::natnet
