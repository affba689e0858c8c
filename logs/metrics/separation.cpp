#include "logs/metrics/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "logs/metrics/whereabouts.h"

namespace roundabout::logs {

namespace {

// Encounters of one pair with less than this between them are one: noise makes a gap near zero
// cross it many times.
constexpr core::Utime kMergeUs = 200'000;
// Of a time in which nobody knows no more than this is believed to be as the frame before it.
constexpr core::Utime kLongestFrameUs = 100'000;
// Less than this from one frame to the next is no way to divide by.
constexpr double kStandingM = 1e-6;

std::vector<Whereabouts> whereaboutsIn(const Flight& flight) {
  std::vector<Whereabouts> whereabouts;
  for (const FlightVehicle& vehicle : flight.vehicles) {
    whereabouts.emplace_back(flight, vehicle);
  }
  return whereabouts;
}

/// How one of two moved as seen from the other, in a straight line.
struct Passage {
  core::Utime begin;
  core::Utime end;
  Eigen::Vector2d from_m;
  Eigen::Vector2d way_m;

  core::Utime utimeAt(double share) const {
    return begin + core::toUtime(share * core::toSeconds(end - begin));
  }
};

/// Of the way, when and how near they came.
struct Approach {
  double share;
  double distance_m;
};

bool standsStill(const Passage& passage) { return passage.way_m.norm() < kStandingM; }

/// On the endless line.
double shareAtClosest(const Passage& passage) {
  return standsStill(passage) ? 0.0
                              : -passage.from_m.dot(passage.way_m) / passage.way_m.squaredNorm();
}

Approach closestOf(const Passage& passage) {
  const double share = std::clamp(shareAtClosest(passage), 0.0, 1.0);
  return {share, (passage.from_m + share * passage.way_m).norm()};
}

/// The part of the way nearer than a distance, which it comes.
std::pair<double, double> sharesWithin(const Passage& passage, double distance_m) {
  if (standsStill(passage)) {
    return {0.0, 1.0};
  }
  const double closest = shareAtClosest(passage);
  const double aside_m = (passage.from_m + closest * passage.way_m).norm();
  const double half =
      std::sqrt(std::max(distance_m * distance_m - aside_m * aside_m, 0.0)) / passage.way_m.norm();
  return {std::clamp(closest - half, 0.0, 1.0), std::clamp(closest + half, 0.0, 1.0)};
}

/// From a frame to the next, as far as both are known. Two that rest on the floor were put there;
/// everything else can collide.
std::optional<Passage> passageAfter(const Flight& flight, const Whereabouts& a,
                                    const Whereabouts& b, std::size_t frame) {
  const core::Utime begin = flight.frames[frame].utime;
  if (a.knownAfter(frame) && b.knownAfter(frame)) {
    if (a.restsAfter(frame) && b.restsAfter(frame)) {
      return std::nullopt;
    }
    const Eigen::Vector2d from_m = a.place(frame) - b.place(frame);
    return Passage{begin, flight.frames[frame + 1].utime, from_m,
                   a.place(frame + 1) - b.place(frame + 1) - from_m};
  }
  if (!a.known(frame) || !b.known(frame) || (a.rests(frame) && b.rests(frame))) {
    return std::nullopt;
  }
  const bool last = frame + 1 == flight.frames.size();
  const core::Utime end =
      last ? begin : std::min(flight.frames[frame + 1].utime, begin + kLongestFrameUs);
  return Passage{begin, end, a.place(frame) - b.place(frame), Eigen::Vector2d::Zero()};
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

  void see(const Passage& passage) {
    const Approach approach = closestOf(passage);
    const double gap_m = approach.distance_m - combined_radius_m_;
    if (gap_m < closest_.gap_m) {
      closest_.gap_m = gap_m;
      closest_.at_s = flight_.secondsAt(passage.utimeAt(approach.share));
    }
    if (gap_m < 0.0) {
      const auto [begin, end] = sharesWithin(passage, combined_radius_m_);
      meet(passage.utimeAt(begin), passage.utimeAt(end), gap_m);
    }
  }

  const ClosestGap& closest() const { return closest_; }
  const std::vector<Encounter>& encounters() const { return encounters_; }

 private:
  void meet(core::Utime begin, core::Utime end, double gap_m) {
    if (encounters_.empty() || begin - last_end_utime_ > kMergeUs) {
      const double begin_s = flight_.secondsAt(begin);
      encounters_.push_back({closest_.vehicle_a, closest_.vehicle_b, begin_s, begin_s, 0.0, gap_m});
    }
    Encounter& current = encounters_.back();
    current.time_below_s += core::toSeconds(end - begin);
    current.end_at_s = flight_.secondsAt(end);
    current.closest_gap_m = std::min(current.closest_gap_m, gap_m);
    last_end_utime_ = end;
  }

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
        add(found, i, stretch);
      }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Unseen& a, const Unseen& b) { return a.begin_at_s < b.begin_at_s; });
    return found;
  }

 private:
  void add(std::vector<Unseen>& found, std::size_t vehicle,
           const Whereabouts::Stretch& stretch) const {
    Unseen unseen{flight_.vehicles[vehicle].name,
                  flight_.secondsAt(flight_.frames[stretch.begin].utime),
                  flight_.secondsAt(flight_.frames[stretch.end].utime),
                  {}};
    for (std::size_t other = 0; other < whereabouts_.size(); ++other) {
      if (other != vehicle && couldTouchIn(vehicle, other, stretch)) {
        unseen.near.push_back(flight_.vehicles[other].name);
      }
    }
    if (!unseen.near.empty()) {
      found.push_back(std::move(unseen));
    }
  }

  bool couldTouchIn(std::size_t i, std::size_t j, const Whereabouts::Stretch& stretch) const {
    const double touching_m = flight_.vehicles[i].body_radius_m + flight_.vehicles[j].body_radius_m;
    for (std::size_t frame = stretch.begin; frame < stretch.end; ++frame) {
      // Of two that are unseen at once the first one's line says it.
      const bool said = j < i && !whereabouts_[j].knownAfter(frame);
      if (!said && apartAtLeastM(whereabouts_[i], whereabouts_[j], frame) < touching_m) {
        return true;
      }
    }
    return false;
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
    GapsOverTime::Entry entry{std::numeric_limits<double>::infinity(), 0, 0, 0};
    for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
      for (std::size_t j = i + 1; j < flight.vehicles.size(); ++j) {
        const FlightVehicle& a = flight.vehicles[i];
        const FlightVehicle& b = flight.vehicles[j];
        const auto passage = passageAfter(flight, whereabouts[i], whereabouts[j], frame);
        if (!passage) {
          continue;
        }
        const Approach approach = closestOf(*passage);
        const double gap_m = approach.distance_m - a.body_radius_m - b.body_radius_m;
        if (gap_m < entry.body_gap_m) {
          entry = {gap_m, passage->utimeAt(approach.share), i, j};
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
      closest = {entry.body_gap_m, flight.secondsAt(entry.utime),
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
        if (const auto passage = passageAfter(flight, whereabouts[i], whereabouts[j], frame)) {
          bodies.see(*passage);
          assumed.see(*passage);
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
