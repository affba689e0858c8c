#include "sim/sim_node.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/config/obstacles.h"

namespace roundabout::sim {

namespace {

constexpr core::Utime kAfterEndUs = core::kMicrosPerSecond;

std::vector<std::string> namesOf(const config::Experiment& experiment) {
  std::vector<std::string> names;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    names.push_back(vehicle.name);
  }
  return names;
}

}  // namespace

SimNode::SimNode(const config::Experiment& experiment, bus::Bus& bus, core::Utime first_utime,
                 const std::string& channel, const SteeringFactory& make_steering)
    : experiment_(experiment),
      first_utime_(first_utime),
      next_utime_(first_utime),
      world_(experiment, first_utime, make_steering),
      mocap_(experiment, world_.stepUs(),
             channel == bus::kSceneChannel ? MocapOutput::kScene : MocapOutput::kStates),
      bus_(bus),
      sensors_(experiment, world_, bus),
      publisher_(bus, namesOf(experiment), channel),
      newest_pose_(experiment.vehicles.size(), 0),
      scene_(channel == bus::kSceneChannel) {
  mocap_.observe(world_.now(), sensors_.believed(world_));
  const auto on_error = [this](const bus::DecodeError& error) {
    rejections_.add(error.channel, error.reason);
  };
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    bus::subscribe<roundabout_msgs::command_t>(
        bus, bus::commandChannel(experiment.vehicles[i].name),
        [this, i](const roundabout_msgs::command_t& message) { onCommand(i, message); }, on_error);
  }
  bus::subscribe<roundabout_msgs::fleet_status_t>(
      bus, bus::kFleetStatusChannel,
      [this](const roundabout_msgs::fleet_status_t& message) { onFleetStatus(message); }, on_error);
}

void SimNode::onCommand(std::size_t vehicle, const roundabout_msgs::command_t& message) {
  const std::string& name = experiment_.vehicles[vehicle].name;
  core::Command command;
  const char* reason = message.vehicle == name ? bus::fromMessage(message, command)
                                               : "names another vehicle than its channel";
  if (reason == nullptr) {
    reason = world_.accept(vehicle, sensors_.asDriven(world_, vehicle, command));
  }
  if (reason != nullptr) {
    rejections_.add(bus::commandChannel(name), reason);
  }
}

void SimNode::onFleetStatus(const roundabout_msgs::fleet_status_t& message) {
  if (const char* reason = refusalOf(message)) {
    rejections_.add(bus::kFleetStatusChannel, reason);
    return;
  }
  last_fleet_status_ = std::max(last_fleet_status_, message.utime);
  const bool ended = message.phase == roundabout_msgs::fleet_status_t::DONE ||
                     message.phase == roundabout_msgs::fleet_status_t::FAILED;
  if (ended && !end_utime_) {
    end_utime_ = message.utime + kAfterEndUs;
  }
}

/// What somebody plays from a log, or a fleet of an earlier flight, must not end this one.
const char* SimNode::refusalOf(const roundabout_msgs::fleet_status_t& message) const {
  const bool before_states =
      message.utime == 0 && message.phase == roundabout_msgs::fleet_status_t::WAITING;
  if (before_states) {
    return nullptr;
  }
  if (message.utime < std::max(first_utime_, last_fleet_status_)) {
    return "older than this flight or its last status";
  }
  const core::Utime newest = next_utime_ - (scene_ ? 0 : frameIntervalUs());
  return message.utime <= newest ? nullptr : "newer than the newest frame";
}

void SimNode::advance() {
  while (world_.now() < next_utime_ + latencyUs()) {
    world_.step();
    sensors_.onStep(world_);
    mocap_.observe(world_.now(), sensors_.believed(world_));
  }
  logNewContacts();
  // Of the world as it is now, which is as much newer than the frame as that is late.
  sensors_.measure(world_);
}

core::Utime SimNode::publishFrame() {
  sensors_.publish();
  const core::StatesFrame& frame = exposeNext();
  publisher_.publish(frame);
  for (std::size_t i = 0; i < frame.vehicles.size(); ++i) {
    newest_pose_[i] = frame.vehicles[i].tracked ? frame.utime : newest_pose_[i];
  }
  return publisher_.lastPublished().utime;
}

void SimNode::skipFrame() {
  exposeNext();
  ++skipped_frames_;
}

const core::StatesFrame& SimNode::exposeNext() {
  const core::StatesFrame& frame = mocap_.expose(next_utime_);
  next_utime_ += frameIntervalUs();
  return frame;
}

void SimNode::logNewContacts() {
  const auto contacts = world_.contacts().all();
  for (; logged_contacts_ < contacts.size(); ++logged_contacts_) {
    const Contact& contact = contacts[logged_contacts_];
    spdlog::warn("{} and {} touch {:.2f} s after the first frame",
                 experiment_.vehicles[contact.first].name,
                 contact.with_obstacle
                     ? "obstacle " + config::standingInSim(experiment_)[contact.second].name
                     : experiment_.vehicles[contact.second].name,
                 core::toSeconds(contact.begin - first_utime_));
  }
  const auto encounters = world_.encounters().all();
  for (; logged_encounters_ < encounters.size(); ++logged_encounters_) {
    const Encounter& encounter = encounters[logged_encounters_];
    spdlog::warn(
        "{} and pedestrian {} touch {:.2f} s after the first frame ({:.2f} m/s of the "
        "vehicle's, {:.2f} m/s of the person's)",
        experiment_.vehicles[encounter.vehicle].name, encounter.person,
        core::toSeconds(encounter.begin - first_utime_), encounter.vehicle_closing_mps,
        encounter.person_closing_mps);
  }
}

bool SimNode::finished() const {
  return core::toSeconds(next_utime_ - first_utime_) > experiment_.sim.max_duration_s ||
         (end_utime_ && next_utime_ > *end_utime_);
}

SimNode::Report SimNode::report() const {
  return {publisher_.counters().published,
          skipped_frames_,
          core::toSeconds(next_utime_ - first_utime_),
          world_.contacts().all().size(),
          core::toSeconds(world_.contacts().totalUs()),
          world_.contacts().closestM(),
          rejections_.total(),
          world_.encounters().all().size(),
          static_cast<std::size_t>(
              std::count_if(world_.encounters().all().begin(), world_.encounters().all().end(),
                            [](const Encounter& each) { return each.byVehicle(); })),
          world_.encounters().closestM()};
}

}  // namespace roundabout::sim
