#include "common/plot/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::plot {

namespace {

constexpr std::array<Color, 8> kFew{{{31, 119, 180},
                                     {214, 39, 40},
                                     {44, 160, 44},
                                     {148, 103, 189},
                                     {255, 127, 14},
                                     {23, 165, 180},
                                     {140, 86, 75},
                                     {214, 91, 170}}};

/// Round the colour wheel, every second one darker.
Color onWheel(std::size_t index, std::size_t count) {
  const double hue = 6.0 * static_cast<double>(index) / static_cast<double>(count);
  const double value = index % 2 == 0 ? 215.0 : 150.0;
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return static_cast<int>(value * (1.0 - 0.85 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

int blend(int from, int to, double fraction) {
  return static_cast<int>(std::lround(from + (to - from) * fraction));
}

}  // namespace

Color vehicleColor(std::size_t index, std::size_t count) {
  return count <= kFew.size() ? kFew[index] : onWheel(index, count);
}

Color mix(const Color& from, const Color& to, double fraction) {
  return {blend(from.red, to.red, fraction), blend(from.green, to.green, fraction),
          blend(from.blue, to.blue, fraction)};
}

std::string hex(const Color& color) { return fmt::format("#{:06x}", rgbNumber(color)); }

int rgbNumber(const Color& color) { return (color.red << 16) | (color.green << 8) | color.blue; }

}  // namespace roundabout::plot
