#include "logs/metrics/separation.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "logs/metrics/whereabouts.h"

namespace roundabout::logs {

namespace {

// Encounters of one pair with less than this between them are one: noise makes a gap near zero
// cross it many times.
constexpr core::Utime kMergeUs = 200'000;
// Of lost frames no more than this is believed to have been as close as the frames around them.
constexpr core::Utime kLongestFrameUs = 100'000;

std::vector<Whereabouts> whereaboutsIn(const Flight& flight) {
  std::vector<Whereabouts> whereabouts;
  for (const FlightVehicle& vehicle : flight.vehicles) {
    whereabouts.emplace_back(flight, vehicle);
  }
  return whereabouts;
}

/// Two that rest on the floor were put there; everything else can collide.
bool counts(const Whereabouts& a, const Whereabouts& b, std::size_t frame) {
  return a.known(frame) && b.known(frame) && !(a.rests(frame) && b.rests(frame));
}

double distance(const Whereabouts& a, const Whereabouts& b, std::size_t frame) {
  return (a.place(frame) - b.place(frame)).norm();
}

double timeOfFrame(const Flight& flight, std::size_t frame) {
  if (frame + 1 == flight.frames.size()) {
    return 0.0;
  }
  return core::toSeconds(
      std::min(flight.frames[frame + 1].utime - flight.frames[frame].utime, kLongestFrameUs));
}

/// Collects the encounters and the closest gap of one pair and one kind of radius.
class PairWatch {
 public:
  PairWatch(const Flight& flight, const FlightVehicle& a, const FlightVehicle& b,
            double combined_radius_m)
      : flight_(flight), combined_radius_m_(combined_radius_m) {
    closest_.vehicle_a = a.name;
    closest_.vehicle_b = b.name;
  }

  void see(std::size_t frame, double distance_m) {
    const double gap_m = distance_m - combined_radius_m_;
    const core::Utime utime = flight_.frames[frame].utime;
    if (gap_m < closest_.gap_m) {
      closest_.gap_m = gap_m;
      closest_.at_s = flight_.secondsAt(utime);
    }
    if (gap_m >= 0.0) {
      return;
    }
    const double time_s = timeOfFrame(flight_, frame);
    const core::Utime end_utime = utime + core::toUtime(time_s);
    if (encounters_.empty() || utime - last_end_utime_ > kMergeUs) {
      const double now_s = flight_.secondsAt(utime);
      encounters_.push_back({closest_.vehicle_a, closest_.vehicle_b, now_s, now_s, 0.0, gap_m});
    }
    Encounter& current = encounters_.back();
    current.time_below_s += time_s;
    current.end_at_s = flight_.secondsAt(end_utime);
    current.closest_gap_m = std::min(current.closest_gap_m, gap_m);
    last_end_utime_ = end_utime;
  }

  const ClosestGap& closest() const { return closest_; }
  const std::vector<Encounter>& encounters() const { return encounters_; }

 private:
  const Flight& flight_;
  double combined_radius_m_;
  ClosestGap closest_;
  std::vector<Encounter> encounters_;
  core::Utime last_end_utime_ = 0;
};

void keepCloser(ClosestGap& closest, const ClosestGap& candidate) {
  if (candidate.gap_m < closest.gap_m) {
    closest = candidate;
  }
}

/// Finds when a vehicle could have touched another without being seen.
class UnseenWatch {
 public:
  UnseenWatch(const Flight& flight, const std::vector<Whereabouts>& whereabouts)
      : flight_(flight), whereabouts_(whereabouts) {}

  std::vector<Unseen> find() const {
    std::vector<Unseen> found;
    for (std::size_t i = 0; i < whereabouts_.size(); ++i) {
      for (const Whereabouts::Stretch& stretch : whereabouts_[i].unknown()) {
        const std::size_t last = std::min(stretch.end, flight_.frames.size() - 1);
        add(found, i, stretch.begin == 0 ? 0 : stretch.begin - 1, last,
            [&](std::size_t j) { return couldTouchIn(i, j, stretch); });
      }
      for (std::size_t frame = 0; frame + 1 < flight_.frames.size(); ++frame) {
        if (framesLostAfter(frame) && whereabouts_[i].known(frame) &&
            whereabouts_[i].known(frame + 1)) {
          add(found, i, frame, frame + 1,
              [&](std::size_t j) { return i < j && couldTouchAfter(i, j, frame); });
        }
      }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Unseen& a, const Unseen& b) { return a.begin_at_s < b.begin_at_s; });
    return found;
  }

 private:
  template <class CouldTouch>
  void add(std::vector<Unseen>& found, std::size_t vehicle, std::size_t begin, std::size_t end,
           const CouldTouch& could_touch) const {
    Unseen unseen{flight_.vehicles[vehicle].name,
                  flight_.secondsAt(flight_.frames[begin].utime),
                  flight_.secondsAt(flight_.frames[end].utime),
                  {}};
    for (std::size_t other = 0; other < whereabouts_.size(); ++other) {
      if (other != vehicle && could_touch(other)) {
        unseen.near.push_back(flight_.vehicles[other].name);
      }
    }
    if (!unseen.near.empty()) {
      found.push_back(std::move(unseen));
    }
  }

  bool framesLostAfter(std::size_t frame) const {
    return core::toSeconds(flight_.frames[frame + 1].utime - flight_.frames[frame].utime) >
           flight_.other_track_lost_s;
  }

  bool couldTouch(std::size_t i, std::size_t j, std::size_t frame, core::Utime utime) const {
    return apartAtLeastM(whereabouts_[i], whereabouts_[j], frame, utime) <
           flight_.vehicles[i].body_radius_m + flight_.vehicles[j].body_radius_m;
  }

  bool couldTouchIn(std::size_t i, std::size_t j, const Whereabouts::Stretch& stretch) const {
    for (std::size_t frame = stretch.begin; frame < stretch.end; ++frame) {
      // Of two that are unseen at once the first one's line says it.
      const bool said = j < i && !whereabouts_[j].known(frame);
      if (!said && couldTouch(i, j, frame, flight_.frames[frame].utime)) {
        return true;
      }
    }
    return false;
  }

  /// In the middle of lost frames two that move can have come closest.
  bool couldTouchAfter(std::size_t i, std::size_t j, std::size_t frame) const {
    const bool both_rest = whereabouts_[i].rests(frame) && whereabouts_[j].rests(frame) &&
                           whereabouts_[i].rests(frame + 1) && whereabouts_[j].rests(frame + 1);
    const core::Utime begin = flight_.frames[frame].utime;
    return !both_rest &&
           couldTouch(i, j, frame, begin + (flight_.frames[frame + 1].utime - begin) / 2);
  }

  const Flight& flight_;
  const std::vector<Whereabouts>& whereabouts_;
};

double finish(std::vector<Encounter>& encounters) {
  std::stable_sort(
      encounters.begin(), encounters.end(),
      [](const Encounter& a, const Encounter& b) { return a.begin_at_s < b.begin_at_s; });
  double total_s = 0.0;
  for (const Encounter& encounter : encounters) {
    total_s += encounter.time_below_s;
  }
  return total_s;
}

}  // namespace

GapsOverTime gapsOverTime(const Flight& flight) {
  const std::vector<Whereabouts> whereabouts = whereaboutsIn(flight);
  GapsOverTime gaps;
  gaps.frames.reserve(flight.frames.size());
  for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
    GapsOverTime::Entry entry{std::numeric_limits<double>::infinity(), 0, 0};
    for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
      for (std::size_t j = i + 1; j < flight.vehicles.size(); ++j) {
        const FlightVehicle& a = flight.vehicles[i];
        const FlightVehicle& b = flight.vehicles[j];
        if (!counts(whereabouts[i], whereabouts[j], frame)) {
          continue;
        }
        const double gap_m =
            distance(whereabouts[i], whereabouts[j], frame) - a.body_radius_m - b.body_radius_m;
        if (gap_m < entry.body_gap_m) {
          entry = {gap_m, i, j};
        }
      }
    }
    gaps.frames.push_back(entry);
  }
  return gaps;
}

ClosestGap closestIn(const Flight& flight, const GapsOverTime& gaps, std::size_t begin,
                     std::size_t end) {
  ClosestGap closest;
  for (std::size_t frame = begin; frame < end; ++frame) {
    const GapsOverTime::Entry& entry = gaps.frames[frame];
    if (entry.body_gap_m < closest.gap_m) {
      closest = {entry.body_gap_m, flight.secondsAt(flight.frames[frame].utime),
                 flight.vehicles[entry.vehicle_a].name, flight.vehicles[entry.vehicle_b].name};
    }
  }
  return closest;
}

SeparationMetrics separationOf(const Flight& flight) {
  const std::vector<Whereabouts> whereabouts = whereaboutsIn(flight);
  SeparationMetrics result;
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    for (std::size_t j = i + 1; j < flight.vehicles.size(); ++j) {
      const FlightVehicle& a = flight.vehicles[i];
      const FlightVehicle& b = flight.vehicles[j];
      PairWatch bodies(flight, a, b, a.body_radius_m + b.body_radius_m);
      PairWatch assumed(flight, a, b, a.assumed_radius_m + b.assumed_radius_m);
      for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
        if (counts(whereabouts[i], whereabouts[j], frame)) {
          const double distance_m = distance(whereabouts[i], whereabouts[j], frame);
          bodies.see(frame, distance_m);
          assumed.see(frame, distance_m);
        }
      }
      keepCloser(result.body_gap, bodies.closest());
      keepCloser(result.assumed_gap, assumed.closest());
      result.pairs.push_back({bodies.closest(), static_cast<int>(bodies.encounters().size()),
                              static_cast<int>(assumed.encounters().size())});
      result.touches.insert(result.touches.end(), bodies.encounters().begin(),
                            bodies.encounters().end());
      result.approaches.insert(result.approaches.end(), assumed.encounters().begin(),
                               assumed.encounters().end());
    }
  }
  result.touching_time_s = finish(result.touches);
  result.approaching_time_s = finish(result.approaches);
  result.unseen = UnseenWatch(flight, whereabouts).find();
  return result;
}

}  // namespace roundabout::logs
