#include "sim/sensor_node.h"

#include <utility>
#include <variant>

#include "common/bus/messages.h"
#include "common/bus/typed.h"

namespace roundabout::sim {

namespace {

constexpr double kTruthRate_hz = 20.0;

bool hasPeople(const config::Experiment& experiment) {
  return experiment.pedestrians.count > 0 || !experiment.pedestrians.recording.file.empty();
}

// People, then vehicles with the ids -1, -2, … in the order of the experiment.
core::AgentTracks truthOf(const config::Experiment& experiment, const World& world) {
  core::AgentTracks truth;
  truth.utime = world.now();
  for (const Pedestrian& person : world.people()) {
    core::AgentTrack track;
    track.id = person.id;
    track.agent_class = core::AgentClass::kPedestrian;
    track.confidence = 1.0;
    track.position_world_m = person.position_m;
    track.velocity_world_mps = person.velocity_mps;
    track.radius_m = experiment.pedestrians.body_radius_m;
    truth.tracks.push_back(track);
  }
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const BodyState& body = world.bodies()[i];
    core::AgentTrack track;
    track.id = -1 - static_cast<std::int32_t>(i);
    track.agent_class = core::AgentClass::kVehicle;
    track.confidence = 1.0;
    track.position_world_m = body.position_world_m.head<2>();
    track.velocity_world_mps = body.velocity_world_mps.head<2>();
    track.radius_m = experiment.vehicles[i].body_radius_m;
    truth.tracks.push_back(track);
  }
  return truth;
}

}  // namespace

SensorNode::SensorNode(const config::Experiment& experiment, const World& world, bus::Bus& bus)
    : experiment_(experiment),
      step_s_(experiment.sim.step_s),
      scanners_(experiment),
      cameras_(experiment, bus::kMostImageBytes),
      odometers_(experiment, world.bodies()),
      truth_timer_(kTruthRate_hz),
      newest_scan_(experiment.vehicles.size(), 0),
      bus_(bus) {}

void SensorNode::onStep(const World& world) { odometers_.step(world.wheels(), step_s_); }

void SensorNode::measure(const World& world) {
  sweeps_ = scanners_.sweep(world.now(), world.bodies(), world.people());
  shots_ = cameras_.shoot(world.now(), world.bodies(), world.people());
  readings_ = odometers_.read(world.now());
  if (hasPeople(experiment_) && truth_timer_.due(world.now())) {
    truth_ = truthOf(experiment_, world);
    truth_due_ = true;
  }
}

void SensorNode::publish() {
  const auto& vehicles = experiment_.vehicles;
  if (std::exchange(truth_due_, false)) {
    bus::publish(bus_, bus::kPedestrianTruthChannel, bus::toMessage(truth_));
  }
  for (const Odometers::Reading& reading : std::exchange(readings_, {})) {
    bus::publish(bus_, bus::odometryChannel(vehicles[reading.vehicle].name),
                 bus::toMessage(reading.odometry));
  }
  for (const Cameras::Shot& shot : std::exchange(shots_, {})) {
    const auto message =
        std::visit([](const auto& image) { return bus::toMessage(image); }, shot.image);
    bus::publish(bus_, bus::imageChannel(vehicles[shot.vehicle].name, shot.camera), message);
  }
  for (const LaserScanners::Sweep& sweep : std::exchange(sweeps_, {})) {
    bus::publish(bus_, bus::laserScanChannel(vehicles[sweep.vehicle].name),
                 bus::toMessage(sweep.scan));
    newest_scan_[sweep.vehicle] = sweep.scan.utime;
  }
}

}  // namespace roundabout::sim
