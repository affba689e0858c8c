#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "common/core/agent.h"
#include "logs/flight.h"

namespace roundabout::logs {

/// Where one vehicle was in each frame, as far as its log tells: where the cameras saw it, on the
/// straight line between two sightings that are close in time, or within reach of them.
class Whereabouts {
 public:
  Whereabouts(const Flight& flight, const FlightVehicle& vehicle);

  /// Seen, or on the line. Otherwise only apartAtLeastM() says something.
  bool known(std::size_t frame) const { return places_[frame].known; }
  /// m, world, horizontal. Precondition: known(frame).
  const Eigen::Vector2d& place(std::size_t frame) const { return places_[frame].position_m; }
  /// It stands on the floor with its motors off, or was seen to do so before and after, at one
  /// place. What drives never rests.
  bool rests(std::size_t frame) const { return places_[frame].rests; }

  /// From this frame to the next it is believed to be on the straight line between its places in
  /// them. False for the last frame.
  bool knownAfter(std::size_t frame) const;
  /// From this frame to the next it rests at one place. False for the last frame.
  bool restsAfter(std::size_t frame) const;

  /// From this frame, not the last, to the next the centres of both stayed at least so far apart,
  /// since neither is faster than its top speed. Negative: no statement.
  friend double apartAtLeastM(const Whereabouts& a, const Whereabouts& b, std::size_t frame);
  /// The same of the centre and the sides of a polygon. Negative: it may have been inside.
  double apartAtLeastM(const core::Polygon& polygon_m, std::size_t frame) const;

  /// From the last frame in which it was known() to the next, or the flight's begin or end, where
  /// it is not knownAfter() in between.
  struct Stretch {
    std::size_t begin;
    std::size_t end;
  };
  std::vector<Stretch> unknown() const;

 private:
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

  struct Place {
    bool known = false;
    bool rests = false;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    std::size_t before = kNever;  // the frame of the last sighting, this one included
    std::size_t after = kNever;   // of the next
  };
  struct Circle {
    Eigen::Vector2d centre_m;
    double radius_m;
  };

  void findSightings();
  void judge(std::size_t frame);
  bool restsAt(std::size_t frame) const;
  /// Circles that all hold it at a time from this frame, not the last, to the next.
  std::vector<Circle> reach(std::size_t frame, core::Utime utime) const;

  const Flight& flight_;
  const FlightVehicle& vehicle_;
  core::Utime longest_line_us_;
  std::vector<Place> places_;
};

}  // namespace roundabout::logs
