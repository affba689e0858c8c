#include "logs/metrics/whereabouts.h"

#include <algorithm>
#include <cmath>

#include "common/core/polygon.h"

namespace roundabout::logs {

namespace {

// Slower than this, and low, it is not flying.
constexpr double kRestingMps = 0.2;
// What has moved less than this between two sightings on the floor has not moved.
constexpr double kSamePlaceM = 0.1;

Eigen::Vector2d flat(const Sample& sample) { return sample.position_world_m.head<2>(); }

/// The least value of a function of utime from a frame to the next. It must be convex, as the
/// largest of several linear ones is: circles of reach grow and shrink at constant speed.
template <class Function>
double leastAfter(const Flight& flight, std::size_t frame, const Function& function) {
  constexpr core::Utime kCloseEnoughUs = 1000;
  core::Utime begin = flight.frames[frame].utime;
  core::Utime end = flight.frames[frame + 1].utime;
  double least = std::min(function(begin), function(end));
  while (end - begin > kCloseEnoughUs) {
    const core::Utime third = (end - begin) / 3;
    const double early = function(begin + third);
    const double late = function(end - third);
    least = std::min({least, early, late});
    (early < late ? end : begin) = early < late ? end - third : begin + third;
  }
  return least;
}

}  // namespace

Whereabouts::Whereabouts(const Flight& flight, const FlightVehicle& vehicle)
    : flight_(flight),
      vehicle_(vehicle),
      longest_line_us_(core::toUtime(flight.other_track_lost_s)),
      places_(flight.frames.size()) {
  findSightings();
  for (std::size_t frame = 0; frame < places_.size(); ++frame) {
    judge(frame);
  }
}

void Whereabouts::findSightings() {
  std::size_t seen = kNever;
  for (std::size_t frame = 0; frame < places_.size(); ++frame) {
    seen = vehicle_.samples[frame].tracked ? frame : seen;
    places_[frame].before = seen;
  }
  seen = kNever;
  for (std::size_t frame = places_.size(); frame-- > 0;) {
    seen = vehicle_.samples[frame].tracked ? frame : seen;
    places_[frame].after = seen;
  }
}

bool Whereabouts::restsAt(std::size_t frame) const {
  const Sample& sample = vehicle_.samples[frame];
  return !flight_.underWay(vehicle_, sample) && sample.velocity_world_mps.norm() <= kRestingMps;
}

void Whereabouts::judge(std::size_t frame) {
  Place& place = places_[frame];
  const bool never = place.before == kNever && place.after == kNever;
  if (never) {
    return;
  }
  const std::size_t before = place.before == kNever ? place.after : place.before;
  const std::size_t after = place.after == kNever ? place.before : place.after;
  const Eigen::Vector2d from_m = flat(vehicle_.samples[before]);
  const Eigen::Vector2d way_m = flat(vehicle_.samples[after]) - from_m;
  const core::Utime begin = flight_.frames[before].utime;
  const core::Utime duration = flight_.frames[after].utime - begin;
  place.rests = restsAt(before) && restsAt(after) && way_m.norm() <= kSamePlaceM;
  // With a sighting on one side only there is no line.
  const bool both = place.before != kNever && place.after != kNever;
  place.known = place.rests || (both && duration <= longest_line_us_);
  const double share = before == after ? 0.0
                                       : core::toSeconds(flight_.frames[frame].utime - begin) /
                                             core::toSeconds(duration);
  place.position_m = from_m + (both ? share : 0.0) * way_m;
}

bool Whereabouts::restsAfter(std::size_t frame) const {
  return frame + 1 < places_.size() && rests(frame) && rests(frame + 1) &&
         (place(frame + 1) - place(frame)).norm() <= kSamePlaceM;
}

bool Whereabouts::knownAfter(std::size_t frame) const {
  if (frame + 1 >= places_.size() || !known(frame) || !known(frame + 1)) {
    return false;
  }
  const std::size_t before = places_[frame].before;
  const std::size_t after = places_[frame + 1].after;
  const bool line = before != kNever && after != kNever &&
                    flight_.frames[after].utime - flight_.frames[before].utime <= longest_line_us_;
  return line || restsAfter(frame);
}

std::vector<Whereabouts::Circle> Whereabouts::reach(std::size_t frame, core::Utime utime) const {
  if (knownAfter(frame)) {
    const core::Utime begin = flight_.frames[frame].utime;
    const double share =
        core::toSeconds(utime - begin) / core::toSeconds(flight_.frames[frame + 1].utime - begin);
    return {{place(frame) + share * (place(frame + 1) - place(frame)), 0.0}};
  }
  std::vector<Circle> circles;
  for (const std::size_t sighting : {places_[frame].before, places_[frame + 1].after}) {
    if (sighting != kNever) {
      const double time_s = std::abs(core::toSeconds(utime - flight_.frames[sighting].utime));
      circles.push_back({flat(vehicle_.samples[sighting]), vehicle_.top_speed_mps * time_s});
    }
  }
  return circles;
}

double apartAtLeastM(const Whereabouts& a, const Whereabouts& b, std::size_t frame) {
  return leastAfter(a.flight_, frame, [&](core::Utime utime) {
    double apart_m = -std::numeric_limits<double>::infinity();
    const auto circles_b = b.reach(frame, utime);
    for (const Whereabouts::Circle& circle_a : a.reach(frame, utime)) {
      for (const Whereabouts::Circle& circle_b : circles_b) {
        apart_m = std::max(apart_m, (circle_a.centre_m - circle_b.centre_m).norm() -
                                        circle_a.radius_m - circle_b.radius_m);
      }
    }
    return apart_m;
  });
}

double Whereabouts::apartAtLeastM(const core::Polygon& polygon_m, std::size_t frame) const {
  return leastAfter(flight_, frame, [&](core::Utime utime) {
    double apart_m = -std::numeric_limits<double>::infinity();
    for (const Circle& circle : reach(frame, utime)) {
      apart_m = std::max(apart_m, core::distanceTo(polygon_m, circle.centre_m) - circle.radius_m);
    }
    return apart_m;
  });
}

std::vector<Whereabouts::Stretch> Whereabouts::unknown() const {
  std::vector<Stretch> stretches;
  for (std::size_t frame = 0; frame + 1 < places_.size(); ++frame) {
    if (knownAfter(frame)) {
      continue;
    }
    if (known(frame) || stretches.empty()) {
      stretches.push_back({frame, frame});
    }
    stretches.back().end = frame + 1;
  }
  return stretches;
}

}  // namespace roundabout::logs
