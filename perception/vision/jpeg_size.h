#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace roundabout::perception {

struct PictureSize {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels

  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

/// What the frame header of a JPEG says (ISO/IEC 10918-1, B.2.2), without decoding it: whoever
/// decodes asks for that much memory. Nothing: it has none, or is cut off before it.
std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg);

}  // namespace roundabout::perception
