#pragma once

#include <cstddef>

#include <experimental/simd>

namespace roundabout::planner::shield {

/// So many numbers are computed side by side: two registers of AVX-512, so that one computes while
/// the other waits for its result.
inline constexpr std::size_t kLanes = 16;

using Lanes = std::experimental::simd<double, std::experimental::simd_abi::fixed_size<kLanes>>;
using LaneMask = Lanes::mask_type;

inline Lanes loadLanes(const double* numbers) {
  return Lanes(numbers, std::experimental::element_aligned);
}

/// A vector in each lane.
struct LaneVectors {
  Lanes x;
  Lanes y;

  Lanes squaredNorm() const { return x * x + y * y; }
};

inline LaneVectors operator+(const LaneVectors& a, const LaneVectors& b) {
  return {a.x + b.x, a.y + b.y};
}
inline LaneVectors operator-(const LaneVectors& a, const LaneVectors& b) {
  return {a.x - b.x, a.y - b.y};
}
inline LaneVectors operator*(const Lanes& factor, const LaneVectors& vectors) {
  return {factor * vectors.x, factor * vectors.y};
}
inline LaneVectors operator/(const LaneVectors& vectors, const Lanes& divisor) {
  return {vectors.x / divisor, vectors.y / divisor};
}

}  // namespace roundabout::planner::shield
