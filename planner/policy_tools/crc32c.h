#pragma once

#include <cstdint>
#include <string_view>

namespace roundabout::planner {

/// CRC-32C (Castagnoli, RFC 3720 appendix B.4) of the bytes.
std::uint32_t crc32c(std::string_view bytes);

/// As LevelDB and TensorFlow store it, so that data with its own sum inside still has a good one.
constexpr std::uint32_t maskedCrc32c(std::uint32_t crc) {
  return ((crc >> 15) | (crc << 17)) + 0xa282ead8U;
}

}  // namespace roundabout::planner
