#include "perception/vision/jpeg_size.h"

namespace roundabout::perception {

namespace {

constexpr std::uint8_t kMarker = 0xFF;
constexpr std::uint8_t kStartOfImage = 0xD8;
constexpr std::uint8_t kStartOfScan = 0xDA;

/// SOF0 to SOF15; between them are three other markers: DHT, JPG, DAC.
bool startsFrame(std::uint8_t code) {
  return code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
}

}  // namespace

std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg) {
  if (jpeg.size() < 2 || jpeg[0] != kMarker || jpeg[1] != kStartOfImage) {
    return std::nullopt;
  }
  const auto word = [&](std::size_t i) { return jpeg[i] << 8 | jpeg[i + 1]; };
  std::size_t at = 2;
  while (at + 4 <= jpeg.size() && jpeg[at] == kMarker) {
    const std::uint8_t code = jpeg[at + 1];
    if (code == kMarker) {  // fills up
      ++at;
      continue;
    }
    if (startsFrame(code)) {
      // marker, length, precision, height, width
      return at + 9 <= jpeg.size() ? std::optional(PictureSize{word(at + 7), word(at + 5)})
                                   : std::nullopt;
    }
    if (code == kStartOfScan) {
      return std::nullopt;
    }
    at += 2 + static_cast<std::size_t>(word(at + 2));
  }
  return std::nullopt;
}

}  // namespace roundabout::perception
