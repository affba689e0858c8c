#include "logs/metrics/people.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace roundabout::logs {

namespace {

using Eigen::Vector2d;

const SeenPerson* find(const PeopleFrame& frame, std::int32_t id) {
  const auto found = std::find_if(frame.people.begin(), frame.people.end(),
                                  [id](const SeenPerson& each) { return each.id == id; });
  return found == frame.people.end() ? nullptr : &*found;
}

/// Share of the way from `begin` to `end` at which a point is nearest to the origin.
double nearestShare(const Vector2d& begin, const Vector2d& end) {
  const Vector2d way = end - begin;
  const double square = way.squaredNorm();
  return square > 0.0 ? std::clamp(-begin.dot(way) / square, 0.0, 1.0) : 0.0;
}

/// One vehicle and everybody.
class Watch {
 public:
  Watch(const Flight& flight, std::size_t vehicle, PeopleMetrics& metrics)
      : flight_(flight), vehicle_(vehicle), metrics_(metrics) {}

  void see(const PeopleFrame& now, const PeopleFrame& next) {
    for (const SeenPerson& person : now.people) {
      const SeenPerson* later = find(next, person.id);
      if (later == nullptr || vehicle_ >= now.vehicles_m.size() ||
          vehicle_ >= next.vehicles_m.size()) {
        continue;
      }
      const Vector2d begin = person.position_m - now.vehicles_m[vehicle_];
      const Vector2d end = later->position_m - next.vehicles_m[vehicle_];
      const double share = nearestShare(begin, end);
      const Vector2d apart = begin + share * (end - begin);
      const double gap_m =
          apart.norm() - person.radius_m - flight_.vehicles[vehicle_].body_radius_m;
      const double at_s =
          flight_.secondsAt(now.utime) + share * core::toSeconds(next.utime - now.utime);
      note(person.id, gap_m, at_s);
    }
  }

 private:
  void note(std::int32_t id, double gap_m, double at_s) {
    const std::string& name = flight_.vehicles[vehicle_].name;
    if (gap_m < metrics_.closest.gap_m) {
      metrics_.closest = {gap_m, at_s, name, "pedestrian " + std::to_string(id)};
    }
    if (gap_m >= 0.0) {
      touching_.erase(id);
    } else if (touching_.insert(id).second) {
      metrics_.touches.push_back({gap_m, at_s, name, "pedestrian " + std::to_string(id)});
    }
  }

  const Flight& flight_;
  std::size_t vehicle_;
  PeopleMetrics& metrics_;
  std::set<std::int32_t> touching_;
};

}  // namespace

PeopleMetrics peopleOf(const Flight& flight) {
  PeopleMetrics metrics;
  std::set<std::int32_t> ids;
  for (const PeopleFrame& frame : flight.people) {
    for (const SeenPerson& person : frame.people) {
      ids.insert(person.id);
    }
  }
  metrics.people = static_cast<int>(ids.size());
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    Watch watch(flight, i, metrics);
    for (std::size_t k = 1; k < flight.people.size(); ++k) {
      watch.see(flight.people[k - 1], flight.people[k]);
    }
  }
  return metrics;
}

}  // namespace roundabout::logs
