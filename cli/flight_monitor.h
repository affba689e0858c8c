#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>

#include "common/bus/bus.h"
#include "common/config/experiment.h"
#include "common/core/frame_gate.h"
#include "common/core/vehicle_state.h"
#include "roundabout_msgs/fleet_status_t.hpp"

namespace roundabout::cli {

/// What is known of a flight while it lasts.
struct Progress {
  core::Utime first_utime = 0;  ///< of the first frame, since time went back; 0: none yet
  core::Utime last_utime = 0;
  double closest_separation_m =
      std::numeric_limits<double>::infinity();  ///< between two bodies, horizontal, so far
  roundabout_msgs::fleet_status_t fleet;        ///< the latest; phase WAITING before the first
  std::size_t vehicles = 0;

  double elapsed_s() const { return core::toSeconds(last_utime - first_utime); }
};

/// Listens to a flight. Only vehicles of the experiment count.
class FlightMonitor {
 public:
  struct Events {
    std::function<void()> first_state;
    std::function<void()> fleet_heard;
    std::function<void(const std::string& vehicle, bool on_floor)> planner_heard;
  };

  FlightMonitor(bus::Bus& bus, const config::Experiment& experiment, Events events);

  const Progress& progress() const { return progress_; }
  /// The file's mission was flown to its end and leaves the vehicles in the air, and nobody has
  /// given the fleet another step.
  bool missionOver() const;
  /// The fleet has said that the mission is done or has failed.
  bool missionEnded() const;

 private:
  void onFrame(const core::StatesFrame& frame);

  std::map<std::string, double> body_radius_m_;
  Events events_;
  Progress progress_;
  core::FrameGate gate_;
  core::StatesFrame frame_;
  bool steered_by_message_ = false;
};

/// "GO D (step 3 of 7), 4 of 6 at goal, closest 0.82 m, 34.2 s, 12.3x real time".
std::string describe(const Progress& progress, double wall_s);

}  // namespace roundabout::cli
