#pragma once

#include <cstdint>
#include <random>
#include <string_view>

#include <Eigen/Core>

namespace roundabout::core {

/// A named stream of random numbers. Streams of one seed are independent of each other, so that
/// adding a draw in one place (mocap noise) changes nothing in another (goal assignment).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  double uniform(double low, double high);
  double normal(double standard_deviation);
  Eigen::Vector3d normal3(double standard_deviation);
  bool chance(double probability);
  /// Uniform in [0, count).
  std::size_t index(std::size_t count);

  /// Fisher-Yates, in place.
  template <class Container>
  void shuffle(Container& items) {
    for (std::size_t left = items.size(); left > 1; --left) {
      std::swap(items[left - 1], items[index(left)]);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace roundabout::core
