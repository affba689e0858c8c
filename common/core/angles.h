#pragma once

#include <cmath>
#include <numbers>

namespace roundabout::core {

/// Wraps an angle to [-pi, pi). rad.
inline double wrapToPi(double angle_rad) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  const double shifted = std::fmod(angle_rad + std::numbers::pi, kTwoPi);
  const double wrapped = (shifted < 0.0 ? shifted + kTwoPi : shifted) - std::numbers::pi;
  // A shifted angle just below zero rounds up to two pi.
  return wrapped < std::numbers::pi ? wrapped : -std::numbers::pi;
}

}  // namespace roundabout::core
