#pragma once

#include <limits>
#include <span>
#include <vector>

#include "common/core/agent.h"
#include "common/core/time.h"
#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// One time during which a body overlapped another one or an obstacle.
struct Contact {
  std::size_t first;
  std::size_t second;  ///< body or obstacle
  bool with_obstacle;
  core::Utime begin;
  core::Utime duration_us;
};

/// The truth about collisions: bodies are upright cylinders without end, as everywhere in
/// Roundabout, so flying above each other counts; obstacles reach as high as anybody flies. The
/// bodies themselves do not feel it: they fly through each other and through obstacles.
class Contacts {
 public:
  explicit Contacts(std::vector<double> body_radii_m, std::vector<core::Polygon> obstacles = {});

  /// Looks at every pair, and at every body and obstacle. step_us is how long this situation lasts.
  void update(core::Utime now, core::Utime step_us, std::span<const BodyState> bodies);

  /// In order of their beginning, those that still last included.
  std::span<const Contact> all() const { return contacts_; }
  core::Utime totalUs() const;
  /// Smallest distance between two bodies' edges, or between a body's and an obstacle's, so far;
  /// negative when they overlapped; infinite for one vehicle without obstacles. m.
  double closestM() const { return closest_m_; }

 private:
  static constexpr int kNone = -1;

  /// open: of these two, as in open_.
  void note(double gap_m, const Contact& beginning, core::Utime step_us, int& open);

  std::vector<double> radii_m_;
  std::vector<core::Polygon> obstacles_;
  // [body][other bodies, then obstacles]: index of the contact that lasts, or kNone.
  std::vector<int> open_;
  std::vector<Contact> contacts_;
  double closest_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace roundabout::sim
