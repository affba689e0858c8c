#include "sim/sensors/jpeg.h"

#include <cstdio>  // jpeglib.h uses FILE without including it
#include <cstdlib>
#include <memory>

#include <jpeglib.h>

namespace roundabout::sim {

namespace {

constexpr int kBestQuality = 85;
constexpr int kWorstQuality = 5;
constexpr int kQualityStep = 10;
constexpr int kChannels = 3;

// Its only errors are sizes and memory, which libjpeg's default handler ends the program for.
std::vector<std::uint8_t> encode(std::span<const std::uint8_t> rgb, int width, int height,
                                 int quality) {
  jpeg_error_mgr errors{};
  jpeg_compress_struct compressor{};
  compressor.err = jpeg_std_error(&errors);
  jpeg_create_compress(&compressor);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): libjpeg's type
  jpeg_mem_dest(&compressor, &bytes, &size);
  compressor.image_width = static_cast<JDIMENSION>(width);
  compressor.image_height = static_cast<JDIMENSION>(height);
  compressor.input_components = kChannels;
  compressor.in_color_space = JCS_RGB;
  jpeg_set_defaults(&compressor);
  jpeg_set_quality(&compressor, quality, TRUE);
  jpeg_start_compress(&compressor, TRUE);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(width) * kChannels);
  while (compressor.next_scanline < compressor.image_height) {
    const auto begin = rgb.begin() + static_cast<std::ptrdiff_t>(compressor.next_scanline) *
                                         static_cast<std::ptrdiff_t>(row.size());
    row.assign(begin, begin + static_cast<std::ptrdiff_t>(row.size()));
    JSAMPROW line = row.data();
    jpeg_write_scanlines(&compressor, &line, 1);
  }
  jpeg_finish_compress(&compressor);
  jpeg_destroy_compress(&compressor);
  std::vector<std::uint8_t> result(bytes, bytes + size);
  std::free(bytes);  // NOLINT: libjpeg allocates it with malloc
  return result;
}

}  // namespace

std::vector<std::uint8_t> encodeJpeg(std::span<const std::uint8_t> rgb, int width, int height,
                                     std::size_t most_bytes) {
  int quality = kBestQuality;
  std::vector<std::uint8_t> jpeg = encode(rgb, width, height, quality);
  while (jpeg.size() > most_bytes && quality > kWorstQuality) {
    quality -= kQualityStep;
    jpeg = encode(rgb, width, height, quality);
  }
  return jpeg;
}

}  // namespace roundabout::sim
