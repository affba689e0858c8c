#pragma once

#include <cmath>
#include <numbers>

namespace roundabout::core {

/// Wraps an angle to [-pi, pi). rad.
inline double wrapToPi(double angle_rad) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  const double wrapped = std::fmod(angle_rad + std::numbers::pi, kTwoPi);
  return (wrapped < 0.0 ? wrapped + kTwoPi : wrapped) - std::numbers::pi;
}

}  // namespace roundabout::core
