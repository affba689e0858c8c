#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mocap_bridge/sources/byte_cursor.h"
#include "mocap_bridge/sources/byte_writer.h"

namespace roundabout::mocap_bridge::vicon {

inline constexpr std::uint16_t kDefaultPort = 51001;

struct Object {
  std::string name;
  std::array<double, 3> translation_mm{};
  std::array<double, 3> rotation_rad{};
};

/// One datagram of Vicon Tracker's UDP Object Stream. A frame with more objects than fit comes in
/// several blocks of the same number.
struct Block {
  std::uint32_t frame = 0;
  std::vector<Object> objects;
};

/// Returns nullptr, or why the bytes are no block. Zeros behind the last object are padding.
const char* parseBlock(Bytes datagram, Block& block);

std::vector<std::byte> writeBlock(const Block& block);

}  // namespace roundabout::mocap_bridge::vicon
