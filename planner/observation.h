#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "common/core/agent.h"
#include "planner/others_order.h"

namespace roundabout::planner {

/// The fields of an observation, in their order; docs/observation.md defines them.
inline constexpr std::array<std::string_view, 4> kEgoFields = {"distance_to_goal", "heading",
                                                               "preferred_speed", "radius"};
inline constexpr std::array<std::string_view, 7> kOtherFields = {"position_parallel",
                                                                 "position_orthogonal",
                                                                 "velocity_parallel",
                                                                 "velocity_orthogonal",
                                                                 "radius",
                                                                 "combined_radius",
                                                                 "gap"};

using EgoFeatures = std::array<float, kEgoFields.size()>;
using OtherFeatures = std::array<float, kOtherFields.size()>;

/// What a learned policy sees, in the ego frame: origin at the ego, x ("parallel") towards its
/// goal, y ("orthogonal") to the left of x. m, m/s, rad; not normalised.
struct Observation {
  EgoFeatures ego{};
  std::vector<OtherFeatures> others;  ///< in the order in which they are fed
};

/// The one way from agents to observations. Allocates nothing once it has seen as many others.
class ObservationEncoder {
 public:
  /// max_others: so many are observed, the closest or those that would collide first. Others are
  /// fed in the given order.
  ObservationEncoder(int max_others, OthersOrder order);

  /// All inputs are finite. The result is valid until the next call.
  const Observation& encode(const core::EgoAgent& ego, std::span<const core::OtherAgent> others);

 private:
  /// One other agent before selection.
  struct Candidate {
    double collision_s = 0.0;  ///< time to collision; 0 unless the order goes by it
    double gap_cm = 0.0;       ///< rounded
    double orthogonal_m = 0.0;
    std::size_t index = 0;
    OtherFeatures features{};
  };

  void collect(const core::EgoAgent& ego, std::span<const core::OtherAgent> others,
               const Eigen::Vector2d& parallel);
  void sortMostUrgentFirst();
  void sortMostUrgentLast();

  std::size_t max_others_;
  OthersOrder order_;
  std::vector<Candidate> candidates_;
  Observation observation_;
};

}  // namespace roundabout::planner
