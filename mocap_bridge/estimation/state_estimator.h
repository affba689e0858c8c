#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/config/mapped_body.h"
#include "common/core/vehicle_state.h"
#include "mocap_bridge/estimation/axes.h"
#include "mocap_bridge/estimation/body_tracker.h"
#include "mocap_bridge/sources/source_frame.h"

namespace roundabout::mocap_bridge {

/// Frames of a motion-capture system to the states of the experiment's vehicles: which body is
/// which vehicle, axes, where on the body the vehicle sits, one BodyTracker each. Knows no clock
/// but the frames' exposures and no sockets; the same frames give the same states.
class StateEstimator {
 public:
  struct Vehicle {
    std::string name;
    config::BodyKey key;    ///< of the body that it is
    std::string body;       ///< the same for people: "Hex_1" or "id 4"
    bool streamed = false;  ///< the body was in the last frame
    /// Another vehicle that is mapped to the same body, so that neither is believed.
    std::optional<std::size_t> rival = std::nullopt;
    BodyTracker tracker;
    Verdict last = Verdict::kAbsent;
  };
  struct Counters {
    std::int64_t frames = 0;
    std::int64_t recorded = 0;  ///< played back by the system, refused
    std::int64_t old = 0;       ///< exposed before an earlier frame, refused
    std::int64_t epochs = 0;    ///< times that everything was forgotten, since time went back
  };

  /// `usual_axes`: what mocap.axes "auto" means. Throws core::StartupError: axes that are none.
  StateEstimator(const config::Experiment& experiment, const std::string& usual_axes);

  /// True if the frame was used; states() is then of its exposure.
  bool update(const SourceFrame& frame);
  const core::StatesFrame& states() const { return states_; }
  /// The states at a later time, predicted.
  const core::StatesFrame& statesAt(core::Utime utime);

  const std::vector<Vehicle>& vehicles() const { return vehicles_; }
  const Counters& counters() const { return counters_; }

 private:
  struct Mapping {
    config::BodyKey key;
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    std::size_t hint = 0;  // where it stood in the last frame

    bool is(const BodyPose& body) const;
  };

  const BodyPose* find(Mapping& mapping, const SourceFrame& frame) const;
  MeasuredPose measured(const Mapping& mapping, const BodyPose& body) const;
  bool isOthersPlace(std::size_t vehicle, const Eigen::Vector3d& position_m,
                     core::Utime utime) const;
  bool isSeenAt(std::size_t vehicle, double within_m) const;
  void refuseShared();
  void forget();
  void fill(core::Utime utime);

  AxisMap axes_;
  double scale_;
  bool accept_recorded_;
  std::vector<TrackerSettings> settings_;
  std::vector<Mapping> mappings_;
  std::vector<Vehicle> vehicles_;
  std::vector<double> radii_m_;
  std::vector<std::optional<Eigen::Vector3d>> places_;  // believed, before the frame
  std::vector<const BodyPose*> bodies_;                 // in the frame, while it is handled
  std::vector<std::optional<MeasuredPose>> poses_;      // in the frame
  core::StatesFrame states_;
  Counters counters_;
};

}  // namespace roundabout::mocap_bridge
