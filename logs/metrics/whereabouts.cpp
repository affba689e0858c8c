#include "logs/metrics/whereabouts.h"

#include <algorithm>

namespace roundabout::logs {

namespace {

// Slower than this, and low, it is not flying.
constexpr double kRestingMps = 0.2;
// What has moved less than this between two sightings on the floor has not moved.
constexpr double kSamePlaceM = 0.1;

Eigen::Vector2d flat(const Sample& sample) { return sample.position_world_m.head<2>(); }

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

std::vector<Whereabouts::Circle> Whereabouts::reach(std::size_t frame, core::Utime utime) const {
  const std::size_t next = utime > flight_.frames[frame].utime ? frame + 1 : frame;
  const Place& place = places_[frame];
  const bool stood = place.rests && places_[next].rests;
  if (stood || (next == frame && place.known)) {
    return {{place.position_m, 0.0}};
  }
  std::vector<Circle> circles;
  for (const std::size_t sighting : {place.before, places_[next].after}) {
    if (sighting != kNever) {
      const double time_s = std::abs(core::toSeconds(utime - flight_.frames[sighting].utime));
      circles.push_back({flat(vehicle_.samples[sighting]), vehicle_.top_speed_mps * time_s});
    }
  }
  return circles;
}

double apartAtLeastM(const Whereabouts& a, const Whereabouts& b, std::size_t frame,
                     core::Utime utime) {
  double apart_m = -std::numeric_limits<double>::infinity();
  const auto circles_b = b.reach(frame, utime);
  for (const Whereabouts::Circle& circle_a : a.reach(frame, utime)) {
    for (const Whereabouts::Circle& circle_b : circles_b) {
      apart_m = std::max(apart_m, (circle_a.centre_m - circle_b.centre_m).norm() -
                                      circle_a.radius_m - circle_b.radius_m);
    }
  }
  return apart_m;
}

std::vector<Whereabouts::Stretch> Whereabouts::unknown() const {
  std::vector<Stretch> stretches;
  for (std::size_t frame = 0; frame < places_.size(); ++frame) {
    if (places_[frame].known) {
      continue;
    }
    if (stretches.empty() || stretches.back().end != frame) {
      stretches.push_back({frame, frame});
    }
    stretches.back().end = frame + 1;
  }
  return stretches;
}

}  // namespace roundabout::logs
