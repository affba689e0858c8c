#include "logs/metrics/faults.h"

#include <algorithm>

namespace roundabout::logs {

namespace {

/// Reports every stretch without a word from somebody who shall answer frames.
class SilenceWatch {
 public:
  SilenceWatch(const Flight& flight, std::string who, double nominal_interval_s,
               std::vector<Silence>& silences)
      : flight_(flight),
        who_(std::move(who)),
        nominal_interval_s_(nominal_interval_s),
        silences_(silences),
        last_(flight.frames.front().utime) {}

  void heard(core::Utime utime) {
    if (utime > last_) {
      check(utime, true);
      last_ = utime;
    }
  }

  void finish() { check(flight_.frames.back().utime, false); }

 private:
  void check(core::Utime utime, bool returned) {
    const auto frames =
        static_cast<double>(flight_.frameAt(utime)) - static_cast<double>(flight_.frameAt(last_));
    if (frames * nominal_interval_s_ > kSilenceS) {
      silences_.push_back({who_, flight_.secondsAt(last_), flight_.secondsAt(utime), returned});
    }
  }

  const Flight& flight_;
  std::string who_;
  double nominal_interval_s_;
  std::vector<Silence>& silences_;
  core::Utime last_;
};

bool ended(const std::vector<PhaseMetrics>& phases) {
  return !phases.empty() &&
         (phases.back().phase == FleetPhase::kDone || phases.back().phase == FleetPhase::kFailed);
}

void addStateSilences(const Flight& flight, const std::vector<PhaseMetrics>& phases,
                      std::vector<Silence>& silences) {
  const std::string who = "vehicle states";
  for (std::size_t i = 1; i < flight.frames.size(); ++i) {
    const core::Utime before = flight.frames[i - 1].utime;
    const core::Utime utime = flight.frames[i].utime;
    if (core::toSeconds(utime - before) > kSilenceS) {
      silences.push_back({who, flight.secondsAt(before), flight.secondsAt(utime), true});
    }
  }
  // Without states there is no data time: others are still heard on the wall clock.
  const double after_s = core::toSeconds(flight.log_end_utime - flight.frames.back().log_utime);
  if (after_s > kSilenceS && !ended(phases)) {
    const double last_s = flight.secondsAt(flight.frames.back().utime);
    silences.push_back({who, last_s, last_s + after_s, false});
  }
}

}  // namespace

FaultMetrics faultsOf(const Flight& flight, const std::vector<PhaseMetrics>& phases,
                      double nominal_interval_s) {
  FaultMetrics faults;
  for (const Logged<core::SafetyOrder>& order : flight.safety_orders) {
    faults.safety_orders.push_back({flight.secondsAt(flight.dataTimeOf(order.log_utime)),
                                    nameOf(order.value.order), order.value.vehicle});
  }
  for (const Logged<FleetStatus>& status : flight.fleet) {
    for (const std::string& refusal : status.value.refusals) {
      if (std::find(faults.refusals.begin(), faults.refusals.end(), refusal) ==
          faults.refusals.end()) {
        faults.refusals.push_back(refusal);
      }
    }
  }
  if (flight.frames.empty()) {
    return faults;
  }
  addStateSilences(flight, phases, faults.silences);
  const bool planners_logged =
      std::any_of(flight.vehicles.begin(), flight.vehicles.end(),
                  [](const FlightVehicle& vehicle) { return !vehicle.statuses.empty(); });
  if (planners_logged) {
    for (const FlightVehicle& vehicle : flight.vehicles) {
      SilenceWatch watch(flight, "planner of " + vehicle.name, nominal_interval_s, faults.silences);
      for (const Logged<PlannerStatus>& status : vehicle.statuses) {
        watch.heard(status.value.utime);
      }
      watch.finish();
    }
  }
  if (!flight.fleet.empty()) {
    SilenceWatch watch(flight, "fleet", nominal_interval_s, faults.silences);
    for (const Logged<FleetStatus>& status : flight.fleet) {
      watch.heard(status.value.utime);
    }
    watch.finish();
  }
  std::stable_sort(faults.silences.begin(), faults.silences.end(),
                   [](const Silence& a, const Silence& b) { return a.begin_at_s < b.begin_at_s; });
  return faults;
}

}  // namespace roundabout::logs
