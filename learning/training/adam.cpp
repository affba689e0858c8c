#include "learning/training/adam.h"

#include <cmath>

namespace roundabout::learning {

void Adam::update(const Parameters& gradient, double learning_rate, Parameters& parameters) {
  ++updates;
  const auto count = static_cast<double>(updates);
  const double first_bias = 1.0 - std::pow(kFirstDecay, count);
  const double second_bias = 1.0 - std::pow(second_decay, count);
  const auto step = static_cast<float>(learning_rate / first_bias);
  const auto scale = static_cast<float>(1.0 / std::sqrt(second_bias));
  constexpr auto kFirst = static_cast<float>(kFirstDecay);
  const auto second_kept = static_cast<float>(second_decay);
  const auto small = static_cast<float>(epsilon);
  first = kFirst * first + (1.0F - kFirst) * gradient;
  second.array() = second_kept * second.array() + (1.0F - second_kept) * gradient.array().square();
  parameters.array() -= step * first.array() / (scale * second.array().sqrt() + small);
}

}  // namespace roundabout::learning
