#include <algorithm>
#include <utility>

#include "learning/evaluation/crossing/eyes.h"

namespace roundabout::learning {

namespace {

class TrueEyes final : public Eyes {
 public:
  TrueEyes(const config::Experiment& experiment, std::string vehicle)
      : name_(std::move(vehicle)), person_radius_m_(experiment.pedestrians.body_radius_m) {
    const auto own = std::find_if(experiment.vehicles.begin(), experiment.vehicles.end(),
                                  [&](const config::Vehicle& each) { return each.name == name_; });
    own_ = static_cast<std::size_t>(own - experiment.vehicles.begin());
    range_m_ = own->lidar ? own->lidar->max_range_m : 0.0;
  }

  void onFrame(const core::StatesFrame& frame) override {
    place_m_ = frame.vehicles[own_].position_world_m.head<2>();
  }

  void onScan(const core::LaserScan& scan, std::span<const sim::Pedestrian> people) override {
    core::AgentTracks tracks;
    tracks.utime = scan.utime;
    tracks.vehicle = name_;
    for (const sim::Pedestrian& person : people) {
      if ((person.position_m - place_m_).norm() > range_m_) {
        continue;
      }
      core::AgentTrack track;
      track.id = person.id;
      track.agent_class = core::AgentClass::kPedestrian;
      track.confidence = 1.0;
      track.position_world_m = person.position_m;
      track.velocity_world_mps = person.velocity_mps;
      track.radius_m = person_radius_m_;
      tracks.tracks.push_back(track);
    }
    tracks_ = std::move(tracks);
  }

  std::optional<core::AgentTracks> takeTracks() override {
    return std::exchange(tracks_, std::nullopt);
  }

 private:
  std::string name_;
  double person_radius_m_;
  std::size_t own_ = 0;
  double range_m_ = 0.0;
  Eigen::Vector2d place_m_ = Eigen::Vector2d::Zero();
  std::optional<core::AgentTracks> tracks_;
};

}  // namespace

std::unique_ptr<Eyes> trueEyes(const config::Experiment& experiment, const std::string& vehicle) {
  return std::make_unique<TrueEyes>(experiment, vehicle);
}

}  // namespace roundabout::learning
