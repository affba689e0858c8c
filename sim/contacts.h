#pragma once

#include <limits>
#include <span>
#include <vector>

#include "common/core/time.h"
#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// One time during which two bodies overlapped.
struct Contact {
  std::size_t first;
  std::size_t second;
  core::Utime begin;
  core::Utime duration_us;
};

/// The truth about collisions: bodies are upright cylinders without end, as everywhere in
/// Roundabout, so flying above each other counts. The bodies themselves do not feel it: they fly
/// through each other.
class Contacts {
 public:
  explicit Contacts(std::vector<double> body_radii_m);

  /// Looks at every pair. step_us is how long this situation lasts.
  void update(core::Utime now, core::Utime step_us, std::span<const BodyState> bodies);

  /// In order of their beginning, those that still last included.
  std::span<const Contact> all() const { return contacts_; }
  core::Utime totalUs() const;
  /// Smallest distance between two bodies' edges so far, negative when they overlapped; infinite
  /// for one vehicle. m.
  double closestM() const { return closest_m_; }

 private:
  static constexpr int kNone = -1;

  std::vector<double> radii_m_;
  std::vector<int> open_;  // per pair: index of the contact that lasts, or kNone
  std::vector<Contact> contacts_;
  double closest_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace roundabout::sim
