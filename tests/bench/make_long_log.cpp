// make_long_log FILE [MINUTES]: a log as a long flight of six vehicles leaves it, every message at
// its rate. About a gigabyte an hour. Vehicles circle; planners and fleet say what they would say.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <lcm/eventlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout {
namespace {

constexpr int kVehicles = 6;
constexpr core::Utime kFrame = 5'000;
constexpr core::Utime kBegin = 1'700'000'000'000'000;

class Log {
 public:
  explicit Log(const char* file) : log_(lcm_eventlog_create(file, "w")) {}
  ~Log() {
    if (log_ != nullptr) {
      lcm_eventlog_destroy(log_);
    }
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  bool open() const { return log_ != nullptr; }

  template <class Message>
  void write(core::Utime utime, std::string channel, const Message& message) {
    std::vector<std::byte> bytes = bus::encode(message);
    lcm_eventlog_event_t event{};
    event.timestamp = utime;
    event.channellen = static_cast<std::int32_t>(channel.size());
    event.channel = channel.data();
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.data = bytes.data();
    lcm_eventlog_write_event(log_, &event);
  }

 private:
  lcm_eventlog_t* log_;
};

std::string nameOf(int vehicle) { return "hex" + std::to_string(vehicle + 1); }

core::VehicleState stateOf(int vehicle, double at_s) {
  const double angle_rad = 0.2 * at_s + vehicle * 2.0 * M_PI / kVehicles;
  core::VehicleState state;
  state.name = nameOf(vehicle);
  state.position_world_m = {3.0 * std::cos(angle_rad), 3.0 * std::sin(angle_rad), 1.0};
  state.velocity_world_mps = {-0.6 * std::sin(angle_rad), 0.6 * std::cos(angle_rad), 0.0};
  state.tracked = true;
  return state;
}

void writeTick(Log& log, core::Utime utime, core::Utime data_utime, double at_s) {
  for (int vehicle = 0; vehicle < kVehicles; ++vehicle) {
    core::Command command;
    command.utime = data_utime;
    command.state_utime = data_utime;
    command.vehicle = nameOf(vehicle);
    command.mode = core::CommandMode::kVelocity;
    command.velocity_world_mps = stateOf(vehicle, at_s).velocity_world_mps;
    command.position_world_m.z() = 1.0;
    command.valid_for_s = 0.3;
    roundabout_msgs::planner_status_t status{};
    status.utime = data_utime;
    status.action_probabilities.assign(11, 1.0f / 11);
    status.num_actions = 11;
    status.vehicle = nameOf(vehicle);
    status.policy = "ga3c_cadrl";
    status.mode = roundabout_msgs::planner_status_t::FLYING;
    status.compute_time = 2e-5;
    log.write(utime + 300, bus::plannerStatusChannel(nameOf(vehicle)), status);
    log.write(utime + 350, bus::commandChannel(nameOf(vehicle)), bus::toMessage(command));
  }
}

void writeFleet(Log& log, core::Utime utime, core::Utime data_utime) {
  roundabout_msgs::fleet_status_t status{};
  status.utime = data_utime;
  status.phase = roundabout_msgs::fleet_status_t::HOLD;
  status.formation = "circle";
  status.num_steps = 1;
  status.num_vehicles = kVehicles;
  for (int vehicle = 0; vehicle < kVehicles; ++vehicle) {
    auto& progress = status.vehicles.emplace_back();
    progress = {};
    progress.vehicle = nameOf(vehicle);
    progress.goal_id = 1000 + vehicle;
    progress.planner_alive = 1;
  }
  log.write(utime + 400, bus::kFleetStatusChannel, status);
}

// A lidar's sweep of one vehicle, so that a log has messages of every size.
void writeScan(Log& log, core::Utime utime, core::Utime data_utime) {
  core::LaserScan scan;
  scan.utime = data_utime;
  scan.ranges_m.assign(512, 4.0f);
  log.write(utime + 100, bus::laserScanChannel(nameOf(0)), bus::toMessage(scan));
}

int make(const char* file, double minutes) {
  Log log(file);
  if (!log.open()) {
    std::fprintf(stderr, "make_long_log: %s cannot be written\n", file);
    return 2;
  }
  const auto frames = static_cast<std::int64_t>(minutes * 60.0 * 200.0);
  core::StatesFrame frame;
  for (std::int64_t i = 0; i < frames; ++i) {
    const core::Utime data_utime = core::kMicrosPerSecond + i * kFrame;
    const core::Utime utime = kBegin + i * kFrame;
    const double at_s = core::toSeconds(i * kFrame);
    frame.utime = data_utime;
    frame.frame_number = i;
    frame.vehicles.clear();
    for (int vehicle = 0; vehicle < kVehicles; ++vehicle) {
      frame.vehicles.push_back(stateOf(vehicle, at_s));
    }
    log.write(utime, bus::kStatesChannel, bus::toMessage(frame));
    if (i % 5 == 0) {
      writeScan(log, utime, data_utime);
    }
    if (i % 20 == 0) {
      writeTick(log, utime, data_utime, at_s);
    }
    if (i % 40 == 0) {
      writeFleet(log, utime, data_utime);
    }
  }
  return 0;
}

}  // namespace
}  // namespace roundabout

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: make_long_log FILE [MINUTES]\n");
    return 2;
  }
  return roundabout::make(argv[1], argc > 2 ? std::atof(argv[2]) : 60.0);
}
