#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace roundabout::sim {

/// A JPEG of RGB pixels, three bytes each, row by row from the top. The quality falls from 85 until
/// the result is at most `most_bytes`; at quality 5 it is what it is.
std::vector<std::uint8_t> encodeJpeg(std::span<const std::uint8_t> rgb, int width, int height,
                                     std::size_t most_bytes);

}  // namespace roundabout::sim
