#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/core/agent.h"

namespace roundabout::sim {

/// How one person wants to walk. One object serves one person.
class Steering {
 public:
  Steering() = default;
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;
  virtual ~Steering() = default;

  /// m/s, world, from now on. others: people first, then `vehicles` vehicles, which it minds by the
  /// share `cooperation`.
  virtual Eigen::Vector2d velocity(const core::EgoAgent& person,
                                   std::span<const core::OtherAgent> others, std::size_t vehicles,
                                   double cooperation,
                                   std::span<const core::Polygon> obstacles) = 0;
};

/// Makes the steering of one person.
using SteeringFactory = std::function<std::unique_ptr<Steering>()>;

/// Social forces (Helbing and Molnar, "Social force model for pedestrian dynamics", Phys. Rev. E
/// 51, 1995; the constants of its section III): a person relaxes towards its wish within 0.5 s, is
/// repelled by others along ellipses that reach ahead of them by a step, by what is behind it half
/// as much, by walls, and by whatever it nearly touches, or would within its reaction time.
class SocialForce final : public Steering {
 public:
  Eigen::Vector2d velocity(const core::EgoAgent& person, std::span<const core::OtherAgent> others,
                           std::size_t vehicles, double cooperation,
                           std::span<const core::Polygon> obstacles) override;

  static constexpr double kPeriodS = 0.1;     ///< between calls
  static constexpr double kReactionS = 0.25;  ///< velocity behind the wish
};

}  // namespace roundabout::sim
