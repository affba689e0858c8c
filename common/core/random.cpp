#include "common/core/random.h"

#include <cmath>
#include <numbers>

namespace roundabout::core {

namespace {

// FNV-1a: any stable hash does, it only has to tell the streams apart.
std::uint64_t hashOf(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char character : name) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3ULL;
  }
  return hash;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(hashOf(name)),
                         static_cast<std::uint32_t>(hashOf(name) >> 32)};
  engine_.seed(sequence);
}

double RandomStream::uniform(double low, double high) {
  constexpr double kInverse = 1.0 / 9007199254740992.0;  // 2^-53
  return low + (high - low) * (static_cast<double>(engine_() >> 11) * kInverse);
}

double RandomStream::normal(double standard_deviation) {
  // Box-Muller, one of the pair: two draws always, so that the stream's position does not depend on
  // values.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
  return standard_deviation * radius * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
}

Eigen::Vector3d RandomStream::normal3(double standard_deviation) {
  const double x = normal(standard_deviation);
  const double y = normal(standard_deviation);
  const double z = normal(standard_deviation);
  return {x, y, z};
}

bool RandomStream::chance(double probability) { return uniform(0.0, 1.0) < probability; }

std::size_t RandomStream::index(std::size_t count) {
  // The modulo bias is below 2^-50 for any count that fits a fleet.
  return static_cast<std::size_t>(engine_() % count);
}

}  // namespace roundabout::core
