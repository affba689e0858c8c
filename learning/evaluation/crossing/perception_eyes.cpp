#include <utility>

#include "learning/evaluation/crossing/eyes.h"
#include "perception/perception_core.h"

namespace roundabout::learning {

namespace {

class PerceptionEyes final : public Eyes {
 public:
  PerceptionEyes(const config::Experiment& experiment, const std::string& vehicle)
      : core_(experiment, vehicle, nullptr) {}

  void onFrame(const core::StatesFrame& frame) override { core_.onFrame(frame); }
  void onScan(const core::LaserScan& scan, std::span<const sim::Pedestrian> /*people*/) override {
    core_.onScan(scan);
  }
  std::optional<core::AgentTracks> takeTracks() override { return core_.takeTracks(); }
  std::optional<core::OccupancyMap> takeMap() override { return core_.takeMap(); }

 private:
  perception::PerceptionCore core_;
};

// Without cameras it must not miss their images.
config::Experiment withoutCameras(config::Experiment experiment) {
  for (config::Vehicle& vehicle : experiment.vehicles) {
    vehicle.cameras.clear();
  }
  return experiment;
}

}  // namespace

std::unique_ptr<Eyes> perceptionEyes(const config::Experiment& experiment,
                                     const std::string& vehicle) {
  return std::make_unique<PerceptionEyes>(withoutCameras(experiment), vehicle);
}

}  // namespace roundabout::learning
