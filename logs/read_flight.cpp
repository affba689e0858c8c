#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/config/experiment_file.h"
#include "logs/flight.h"
#include "logs/frame_choice.h"
#include "logs/reading/event_log.h"
#include "roundabout_msgs/agent_tracks_t.hpp"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::logs {

namespace {

constexpr const char* kUnknownVehicle = "unknown vehicle";
// A status answers a frame, which may be missing in the log.
constexpr core::Utime kLongestLeadUs = core::kMicrosPerSecond;

FlightVehicle vehicleFrom(const config::Vehicle& vehicle) {
  FlightVehicle result;
  result.name = vehicle.name;
  result.assumed_radius_m = vehicle.assumed_radius_m;
  result.body_radius_m = vehicle.body_radius_m;
  result.preferred_speed_mps = vehicle.preferred_speed_mps;
  result.top_speed_mps = vehicle.top_speed_mps;
  result.flies = config::flies(vehicle);
  return result;
}

PlannerStatus fromMessage(const roundabout_msgs::planner_status_t& message) {
  PlannerStatus status;
  status.utime = message.utime;
  status.mode = static_cast<PlannerMode>(message.mode);
  status.policy = message.policy;
  status.reason = message.reason;
  status.compute_time_s = message.compute_time;
  status.shield_layer = static_cast<core::ShieldLayer>(message.shield_layer);
  status.predicted_gap_m = message.predicted_gap;
  status.shield_interventions = message.shield_interventions;
  status.rejected_messages = message.rejected_messages;
  status.rejected_measurements = message.rejected_measurements;
  status.missed_ticks = message.missed_ticks;
  return status;
}

FleetStatus fromMessage(const roundabout_msgs::fleet_status_t& message) {
  FleetStatus status;
  status.utime = message.utime;
  status.phase = static_cast<FleetPhase>(message.phase);
  status.formation = message.formation;
  status.step = message.step;
  status.num_steps = message.num_steps;
  status.reason = message.reason;
  status.refusals = message.refusals;
  return status;
}

/// Fills a Flight from the events of a log.
class FlightReader {
 public:
  explicit FlightReader(Flight& flight) : flight_(flight) {
    for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
      index_.emplace(flight.vehicles[i].name, i);
    }
    // Without an experiment file whoever appears in the states is one of the vehicles.
    open_ = index_.empty();
  }

  FrameChoice chooseFrames(const EventLog& log) {
    FrameChooser chooser;
    int frames = 0;
    for (std::size_t i = 0; i < log.size(); ++i) {
      if (log[i].channel == bus::kStatesChannel && decode(log[i], states_)) {
        chooser.see(i, states_.utime);
        ++frames;
      }
    }
    FrameChoice choice = chooser.longest(log.size());
    flight_.frames_out_of_order = frames - static_cast<int>(choice.events.size());
    return choice;
  }

  /// Precondition: chosen.
  void readStates(const Event& event) {
    bus::decode(event.payload, states_);
    bus::fromMessage(states_, frame_);
    const std::size_t frame_index = flight_.frames.size();
    flight_.frames.push_back({frame_.utime, event.log_utime, frame_.frame_number});
    for (const core::VehicleState& state : frame_.vehicles) {
      FlightVehicle* vehicle = find(state.name, open_);
      if (vehicle == nullptr) {
        reject(event.channel, kUnknownVehicle);
        continue;
      }
      vehicle->samples.resize(frame_index);
      vehicle->samples.push_back({state.position_world_m, state.velocity_world_mps, state.tracked});
    }
  }

  void fillMissingSamples() {
    for (FlightVehicle& vehicle : flight_.vehicles) {
      vehicle.samples.resize(flight_.frames.size());
    }
  }

  void readOther(const Event& event) {
    static constexpr std::string_view kGoal = "GOAL_";
    static constexpr std::string_view kCommand = "COMMAND_";
    static constexpr std::string_view kStatus = "PLANNER_STATUS_";
    if (event.channel == bus::kFleetStatusChannel) {
      readFleet(event);
    } else if (event.channel == bus::kSafetyOrderChannel) {
      readSafetyOrder(event);
    } else if (event.channel == bus::kPedestrianTruthChannel) {
      readPeople(event);
    } else if (event.channel.starts_with(kGoal)) {
      readGoal(event, event.channel.substr(kGoal.size()));
    } else if (event.channel.starts_with(kCommand)) {
      readCommand(event, event.channel.substr(kCommand.size()));
    } else if (event.channel.starts_with(kStatus)) {
      readPlannerStatus(event, event.channel.substr(kStatus.size()));
    }
  }

 private:
  template <class Message>
  bool decode(const Event& event, Message& message) {
    return accept(event, bus::decode(event.payload, message));
  }

  bool accept(const Event& event, const char* problem) {
    if (problem != nullptr) {
      reject(event.channel, problem);
    }
    return problem == nullptr;
  }

  void reject(std::string_view channel, const char* reason) {
    auto found = std::find_if(flight_.rejected.begin(), flight_.rejected.end(),
                              [&](const Rejected& entry) { return entry.channel == channel; });
    if (found == flight_.rejected.end()) {
      found = flight_.rejected.insert(found, {std::string(channel), reason, 0});
    }
    ++found->count;
  }

  FlightVehicle* find(std::string_view name, bool add) {
    const auto found = index_.find(name);
    if (found != index_.end()) {
      return &flight_.vehicles[found->second];
    }
    if (!add) {
      return nullptr;
    }
    config::Vehicle vehicle;
    vehicle.name = name;
    index_.emplace(vehicle.name, flight_.vehicles.size());
    return &flight_.vehicles.emplace_back(vehicleFrom(vehicle));
  }

  /// The vehicle that a channel and the message in it both name; nullptr, counted, otherwise.
  FlightVehicle* addressee(const Event& event, std::string_view in_channel,
                           const std::string& in_message) {
    FlightVehicle* vehicle = in_channel == in_message ? find(in_channel, false) : nullptr;
    accept(event, vehicle == nullptr ? kUnknownVehicle : nullptr);
    return vehicle;
  }

  void readFleet(const Event& event) {
    roundabout_msgs::fleet_status_t message;
    if (decode(event, message) && accept(event, stampProblem(event, message.utime))) {
      flight_.fleet.push_back({event.log_utime, fromMessage(message)});
    }
  }

  /// 0 is a fleet that has no states yet; the last stamp again, one that hears no more of them.
  const char* stampProblem(const Event& event, core::Utime utime) {
    const bool ahead = utime - flight_.dataTimeOf(event.log_utime) > kLongestLeadUs;
    if (utime != 0 && (utime < last_fleet_utime_ || ahead)) {
      return "its time stamp is old, or corrupt";
    }
    last_fleet_utime_ = std::max(last_fleet_utime_, utime);
    return nullptr;
  }

  void readSafetyOrder(const Event& event) {
    roundabout_msgs::safety_order_t message;
    core::SafetyOrder order;
    if (decode(event, message) && accept(event, bus::fromMessage(message, order))) {
      const auto& seen = flight_.safety_orders;
      // Orders are sent again, as they were, until they are obeyed.
      const bool repeated = std::any_of(seen.begin(), seen.end(), [&](const auto& earlier) {
        return earlier.value.utime == order.utime && earlier.value.order == order.order &&
               earlier.value.vehicle == order.vehicle;
      });
      if (!repeated) {
        flight_.safety_orders.push_back({event.log_utime, order});
      }
    }
  }

  void readPeople(const Event& event) {
    roundabout_msgs::agent_tracks_t message;
    core::AgentTracks truth;
    int left_out = 0;
    if (!decode(event, message) || !accept(event, bus::fromMessage(message, truth, left_out))) {
      return;
    }
    if (!flight_.people.empty() && truth.utime <= flight_.people.back().utime) {
      reject(event.channel, "its time stamp is old, or corrupt");
      return;
    }
    PeopleFrame frame;
    frame.utime = truth.utime;
    for (const core::AgentTrack& track : truth.tracks) {
      if (track.agent_class == core::AgentClass::kVehicle) {
        frame.vehicles_m.push_back(track.position_world_m);
      } else {
        frame.people.push_back({track.id, track.position_world_m, track.radius_m});
      }
    }
    flight_.people.push_back(std::move(frame));
  }

  void readGoal(const Event& event, std::string_view name) {
    roundabout_msgs::goal_t message;
    core::Goal goal;
    if (!decode(event, message) || !accept(event, bus::fromMessage(message, goal))) {
      return;
    }
    FlightVehicle* vehicle = addressee(event, name, goal.vehicle);
    if (vehicle == nullptr) {
      return;
    }
    const bool repeated = !vehicle->goals.empty() &&
                          vehicle->goals.back().value.utime == goal.utime &&
                          vehicle->goals.back().value.goal_id == goal.goal_id;
    if (!repeated) {
      vehicle->goals.push_back({event.log_utime, goal});
    }
  }

  void readCommand(const Event& event, std::string_view name) {
    roundabout_msgs::command_t message;
    core::Command command;
    if (!decode(event, message) || !accept(event, bus::fromMessage(message, command))) {
      return;
    }
    if (FlightVehicle* vehicle = addressee(event, name, command.vehicle)) {
      vehicle->commands.push_back({event.log_utime, command});
    }
  }

  void readPlannerStatus(const Event& event, std::string_view name) {
    roundabout_msgs::planner_status_t message;
    if (!decode(event, message)) {
      return;
    }
    if (FlightVehicle* vehicle = addressee(event, name, message.vehicle)) {
      vehicle->statuses.push_back({event.log_utime, fromMessage(message)});
    }
  }

  Flight& flight_;
  std::map<std::string, std::size_t, std::less<>> index_;
  bool open_ = false;
  core::Utime last_fleet_utime_ = 0;
  roundabout_msgs::vehicle_states_t states_;
  core::StatesFrame frame_;
};

void readExperimentFor(Flight& flight, const std::string& experiment_file) {
  flight.airborne_height_m = config::Safety().airborne_height_m;
  flight.other_track_lost_s = config::Safety().other_track_lost_s;
  const auto sibling = std::filesystem::path(flight.log_file).parent_path() / "experiment.yaml";
  const bool found = std::filesystem::exists(sibling);
  if (experiment_file.empty() && !found) {
    const config::Vehicle defaults;
    flight.experiment_note = fmt::format(
        "no experiment.yaml beside the log: body radius {} m, assumed radius {} m and preferred "
        "speed {} m/s are defaults",
        defaults.body_radius_m, defaults.assumed_radius_m, defaults.preferred_speed_mps);
    return;
  }
  const std::string file = experiment_file.empty() ? sibling.string() : experiment_file;
  flight.experiment = config::readExperiment(file);
  flight.experiment_note = "radii and speeds from " + file;
  flight.airborne_height_m = flight.experiment->safety.airborne_height_m;
  flight.other_track_lost_s = flight.experiment->safety.other_track_lost_s;
  for (const config::Vehicle& vehicle : flight.experiment->vehicles) {
    flight.vehicles.push_back(vehicleFrom(vehicle));
  }
}

}  // namespace

Flight readFlight(const std::string& log_file, const std::string& experiment_file) {
  const EventLog log(log_file);
  Flight flight;
  flight.log_file = log_file;
  flight.damage = log.damage();
  flight.log_begin_utime = log[0].log_utime;
  flight.log_end_utime = log[log.size() - 1].log_utime;
  readExperimentFor(flight, experiment_file);

  // States first: they say which vehicles there are, and planners may have been heard earlier.
  FlightReader reader(flight);
  const FrameChoice choice = reader.chooseFrames(log);
  for (const std::size_t event : choice.events) {
    reader.readStates(log[event]);
  }
  reader.fillMissingSamples();
  for (std::size_t i = choice.begin; i < choice.end; ++i) {
    if (log[i].channel != bus::kStatesChannel) {
      reader.readOther(log[i]);
    }
  }
  return flight;
}

}  // namespace roundabout::logs
