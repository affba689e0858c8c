#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/messages.h"
#include "common/config/experiment.h"
#include "common/core/vehicle_state.h"
#include "mocap_bridge/state_publisher.h"
#include "roundabout_msgs/command_t.hpp"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "sim/mocap_model.h"
#include "sim/rejections.h"
#include "sim/sensor_node.h"
#include "sim/world.h"

namespace roundabout::sim {

/// The simulator on a bus: COMMAND_<vehicle> in, VEHICLE_STATES and what vehicles' sensors publish
/// out. It does not wait for anything: when the next frame goes out is the pacing's business.
class SimNode {
 public:
  struct Report {
    std::int64_t frames;
    std::int64_t skipped_frames;
    double data_time_s;
    std::size_t contacts;
    double contact_s;
    double closest_m;
    int refused_messages;
    std::size_t encounters;  ///< of vehicles with people
    std::size_t encounters_by_vehicle;
    double closest_person_m;
  };

  /// Frame k has utime first_utime + k frame intervals. Throws core::StartupError as World.
  /// States go out on `channel`. make_steering: as of World.
  SimNode(const config::Experiment& experiment, bus::Bus& bus, core::Utime first_utime,
          const std::string& channel = bus::kStatesChannel,
          const SteeringFactory& make_steering = {});

  /// Advances the world to the time at which the next frame goes out. The commands that are handled
  /// until the next call reach their vehicles at that time.
  void advance();
  /// Publishes what sensors have that is due, then the frame that the last advance() was for,
  /// so that who has heard the frame has the scans too; returns the frame's utime.
  core::Utime publishFrame();
  /// In place of publishFrame(): the frame is lost, its number too.
  void skipFrame();

  core::Utime nextFrameUtime() const { return next_utime_; }
  core::Utime frameIntervalUs() const { return mocap_.frameIntervalUs(); }
  core::Utime latencyUs() const { return mocap_.latencyUs(); }

  /// utime of the newest frame with a pose of a vehicle in it; 0: none.
  core::Utime newestPose(std::size_t vehicle) const { return newest_pose_[vehicle]; }

  /// True a second of data time after the fleet said that the mission is done or has failed, and
  /// after sim.max_duration_s.
  bool finished() const;

  const World& world() const { return world_; }
  const SensorNode& sensors() const { return sensors_; }
  const Rejections& rejections() const { return rejections_; }
  Report report() const;

 private:
  void onCommand(std::size_t vehicle, const roundabout_msgs::command_t& message);
  void onFleetStatus(const roundabout_msgs::fleet_status_t& message);
  const char* refusalOf(const roundabout_msgs::fleet_status_t& message) const;
  const core::StatesFrame& exposeNext();
  void logNewContacts();

  const config::Experiment experiment_;
  const core::Utime first_utime_;
  core::Utime next_utime_;
  std::optional<core::Utime> end_utime_;
  core::Utime last_fleet_status_ = 0;
  World world_;
  MocapModel mocap_;
  bus::Bus& bus_;
  SensorNode sensors_;
  mocap_bridge::StatePublisher publisher_;
  std::vector<core::Utime> newest_pose_;  // of each vehicle
  // Seen through a motion-capture system, frames come back with stamps that are right to a part of
  // their interval.
  const bool scene_;
  Rejections rejections_;
  std::int64_t skipped_frames_ = 0;
  std::size_t logged_contacts_ = 0;
  std::size_t logged_encounters_ = 0;
};

}  // namespace roundabout::sim
