#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/config/experiment.h"
#include "sim/lockstep_barrier.h"
#include "sim/sim_node.h"

namespace roundabout::sim {

/// Steps as soon as everybody has answered, perceptions their scans too, so that a flight runs as
/// fast as the machine allows and comes out the same every time.
class LockstepPacing {
 public:
  /// utime of the first frame, whatever the wall clock says.
  static constexpr core::Utime kFirstUtime = core::kMicrosPerSecond;

  LockstepPacing(const config::Experiment& experiment, bus::Bus& bus);

  /// Waits until all planners, perceptions and the fleet have been heard. Throws core::StartupError
  /// naming who is missing after sim.lockstep_start_s.
  void waitForEverybody(const std::function<bool()>& stop);

  /// Publishes frames until the node is finished or stop() is true, no faster than
  /// sim.lockstep_max_factor times real time. Who does not answer a frame within
  /// sim.lockstep_patience_s is not waited for until it is heard again.
  void run(SimNode& node, const std::function<bool()>& stop);

 private:
  using Clock = std::chrono::steady_clock;

  /// The perception of a vehicle.
  struct Watcher {
    std::size_t vehicle;
    bool present = false;
    core::Utime newest = 0;  ///< utime of its tracks
  };

  void subscribe();
  void subscribeWatchers();
  void awaitAnswers(const SimNode& node, const std::function<bool()>& stop);
  /// It has a pose from after a scan, and has not said what it saw. While nobody sees its vehicle
  /// it has none.
  static bool awaited(const Watcher& watcher, const SimNode& node);
  bool everybodyPresent() const;
  std::string namesOf(const std::vector<std::size_t>& participants) const;
  std::string absentNames() const;

  const config::Experiment experiment_;
  bus::Bus& bus_;
  LockstepBarrier barrier_;
  std::vector<Watcher> watchers_;
};

}  // namespace roundabout::sim
