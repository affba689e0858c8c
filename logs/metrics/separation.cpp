#include "logs/metrics/separation.h"

#include <algorithm>
#include <limits>

namespace roundabout::logs {

namespace {

// Encounters of one pair with less than this between them are one: noise makes a gap near zero
// cross it many times.
constexpr core::Utime kMergeUs = 200'000;
// Of lost frames no more than this is believed to have been as close as the frames around them.
constexpr core::Utime kLongestFrameUs = 100'000;

double distance(const FlightVehicle& a, const FlightVehicle& b, std::size_t frame) {
  return (a.samples[frame].position_world_m - b.samples[frame].position_world_m).head<2>().norm();
}

bool bothUnderWay(const Flight& flight, const FlightVehicle& a, const FlightVehicle& b,
                  std::size_t frame) {
  return flight.underWay(a, a.samples[frame]) && flight.underWay(b, b.samples[frame]);
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
  GapsOverTime gaps;
  gaps.frames.reserve(flight.frames.size());
  for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
    GapsOverTime::Entry entry{std::numeric_limits<double>::infinity(), 0, 0};
    for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
      for (std::size_t j = i + 1; j < flight.vehicles.size(); ++j) {
        const FlightVehicle& a = flight.vehicles[i];
        const FlightVehicle& b = flight.vehicles[j];
        if (!bothUnderWay(flight, a, b, frame)) {
          continue;
        }
        const double gap_m = distance(a, b, frame) - a.body_radius_m - b.body_radius_m;
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
  SeparationMetrics result;
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    for (std::size_t j = i + 1; j < flight.vehicles.size(); ++j) {
      const FlightVehicle& a = flight.vehicles[i];
      const FlightVehicle& b = flight.vehicles[j];
      PairWatch bodies(flight, a, b, a.body_radius_m + b.body_radius_m);
      PairWatch assumed(flight, a, b, a.assumed_radius_m + b.assumed_radius_m);
      for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
        if (bothUnderWay(flight, a, b, frame)) {
          const double distance_m = distance(a, b, frame);
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
  return result;
}

}  // namespace roundabout::logs
