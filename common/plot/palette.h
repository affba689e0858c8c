#pragma once

#include <cstddef>
#include <string>

namespace roundabout::plot {

struct Color {
  int red = 0;
  int green = 0;
  int blue = 0;
};

/// One of `count` colours that tell vehicles apart.
Color vehicleColor(std::size_t index, std::size_t count);

/// From `from` (0) to `to` (1).
Color mix(const Color& from, const Color& to, double fraction);

/// "#rrggbb"
std::string hex(const Color& color);

/// As gnuplot's variable colours want it.
int rgbNumber(const Color& color);

inline constexpr Color kWhite{255, 255, 255};
inline constexpr Color kBlack{0, 0, 0};

}  // namespace roundabout::plot
