#pragma once

#include <set>
#include <string>
#include <utility>

#include "common/bus/bus.h"
#include "perception/perception_core.h"

namespace roundabout::perception {

/// Perception's wires: VEHICLE_STATES, LASER_SCAN_<vehicle> and IMAGE_<vehicle>_<camera> in,
/// AGENT_TRACKS_<vehicle> and OCCUPANCY_<vehicle> out. The bus's handle() drives it.
class PerceptionNode {
 public:
  /// Throws core::StartupError as PerceptionCore.
  PerceptionNode(const config::Experiment& experiment, const std::string& vehicle,
                 std::unique_ptr<PersonDetector> detector, bus::Bus& bus);
  PerceptionNode(const PerceptionNode&) = delete;
  PerceptionNode& operator=(const PerceptionNode&) = delete;

  PerceptionCore& core() { return core_; }

  /// Says that it is there, and blind, as long as it has not heard of any state. For those that
  /// wait for everybody before they begin; call it a few times a second of wall clock.
  void announce();

 private:
  void subscribe();
  void subscribeCamera(std::size_t camera);
  template <class Image>
  void subscribeImages(std::size_t camera,
                       const char* (PerceptionCore::*on_image)(std::size_t, const Image&));
  /// Publishes what the core has to say after a message that took since `begin`.
  void publish(std::chrono::steady_clock::time_point begin);
  void logRejection(std::string_view channel, const char* reason);
  void logHealth(const core::AgentTracks& tracks);

  PerceptionCore core_;
  bus::Bus& bus_;
  core::StatesFrame frame_;
  std::set<std::pair<std::string, std::string>> rejections_logged_;  // channel and reason
  std::string logged_health_;
};

}  // namespace roundabout::perception
