#include "learning/training/adam.h"

#include <cmath>

namespace roundabout::learning {

void Adam::update(const Parameters& gradient, double learning_rate, Parameters& parameters) {
  ++updates;
  const auto count = static_cast<double>(updates);
  const double first_bias = 1.0 - std::pow(kFirstDecay, count);
  const double second_bias = 1.0 - std::pow(kSecondDecay, count);
  const auto step = static_cast<float>(learning_rate / first_bias);
  const auto scale = static_cast<float>(1.0 / std::sqrt(second_bias));
  constexpr auto kFirst = static_cast<float>(kFirstDecay);
  constexpr auto kSecond = static_cast<float>(kSecondDecay);
  constexpr auto kSmall = static_cast<float>(kEpsilon);
  first = kFirst * first + (1.0F - kFirst) * gradient;
  second.array() = kSecond * second.array() + (1.0F - kSecond) * gradient.array().square();
  parameters.array() -= step * first.array() / (scale * second.array().sqrt() + kSmall);
}

}  // namespace roundabout::learning
