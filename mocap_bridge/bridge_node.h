#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "mocap_bridge/estimation/state_estimator.h"
#include "mocap_bridge/sources/source.h"
#include "mocap_bridge/state_publisher.h"

namespace roundabout::mocap_bridge {

/// A motion-capture system on a bus: frames in, VEHICLE_STATES out, one a camera frame or
/// resampled. Time is its caller's.
class BridgeNode final : private PacketSink {
 public:
  /// Throws core::StartupError as StateEstimator.
  BridgeNode(const config::Experiment& experiment, std::unique_ptr<Source> source,
             const std::string& usual_axes, bus::Bus& bus);

  /// Handles what has arrived and publishes what is due. `now`: us, Unix time of a clock that does
  /// not jump.
  void poll(core::Utime now);
  /// Until when, on the clock of `now`, there is nothing to do but wait for packets.
  core::Utime nextDeadline(core::Utime now) const;
  void addDescriptors(std::vector<pollfd>& descriptors) const {
    source_->addDescriptors(descriptors);
  }
  bool finished() const { return source_->finished(); }

  /// Whether body names, units and axes have been looked at, in the frames of 2 s.
  bool setUpChecked() const { return set_up_checked_; }
  /// Lines for the operator since the last call.
  std::vector<std::string> takeNotes();
  std::string report() const;

  const Source& source() const { return *source_; }
  const StateEstimator& estimator() const { return estimator_; }
  const StatePublisher& publisher() const { return publisher_; }

 private:
  void onFrame(const SourceFrame& frame) override;
  void publishResampled(core::Utime data_time);
  void noteTracks(const SourceFrame& frame);
  void noteSetUp(const SourceFrame& frame);
  void notePose(std::size_t vehicle);
  void noteDistances();
  void noteUnused(const StateEstimator::Vehicle& vehicle);

  config::Room room_;
  std::vector<double> radii_m_;
  bool resampled_;
  core::Utime period_us_;
  std::unique_ptr<Source> source_;
  StateEstimator estimator_;
  StatePublisher publisher_;
  Notes notes_;
  core::Utime first_frame_ = 0;  // exposure
  core::Utime last_frame_ = 0;
  core::Utime frames_since_ = 0;  // without a gap
  bool set_up_checked_ = false;
  core::Utime last_tick_ = 0;
  std::int64_t ticks_ = 0;
};

}  // namespace roundabout::mocap_bridge
