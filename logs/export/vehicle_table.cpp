#include <cmath>
#include <limits>

#include "logs/export/csv.h"
#include "logs/export/csv_table.h"

namespace roundabout::logs {

namespace {

/// The latest of a vehicle's messages at a time that only grows.
template <class Value>
class Latest {
 public:
  explicit Latest(const std::vector<Logged<Value>>& all) : all_(all) {}

  const Value* at(core::Utime utime) {
    while (next_ < all_.size() && all_[next_].value.utime <= utime) {
      ++next_;
    }
    return next_ == 0 ? nullptr : &all_[next_ - 1].value;
  }

 private:
  const std::vector<Logged<Value>>& all_;
  std::size_t next_ = 0;
};

void vectorOrBlank(CsvTable& table, const Eigen::Vector3d* vector, int axes) {
  for (int axis = 0; axis < axes; ++axis) {
    table.fixed(vector == nullptr ? std::numeric_limits<double>::quiet_NaN() : (*vector)[axis], 6);
  }
}

/// What goes on with one vehicle besides its states.
struct Track {
  const FlightVehicle& vehicle;
  Latest<core::Goal> goals;
  Latest<core::Command> commands;
  Latest<PlannerStatus> statuses;

  explicit Track(const FlightVehicle& of)
      : vehicle(of), goals(of.goals), commands(of.commands), statuses(of.statuses) {}

  void row(CsvTable& table, const Flight& flight, std::size_t frame) {
    const core::Utime utime = flight.frames[frame].utime;
    const Sample& sample = vehicle.samples[frame];
    table.fixed(flight.secondsAt(utime), 6);
    table.integer(utime);
    table.integer(flight.frames[frame].number);
    table.text(vehicle.name);
    table.integer(sample.tracked ? 1 : 0);
    vectorOrBlank(table, sample.tracked ? &sample.position_world_m : nullptr, 3);
    vectorOrBlank(table, sample.tracked ? &sample.velocity_world_mps : nullptr, 3);
    const core::Goal* goal = goals.at(utime);
    vectorOrBlank(table, goal == nullptr ? nullptr : &goal->position_world_m, 3);
    const core::Command* command = commands.at(utime);
    const bool velocity = command != nullptr && command->mode == core::CommandMode::kVelocity;
    vectorOrBlank(table, velocity ? &command->velocity_world_mps : nullptr, 2);
    const PlannerStatus* status = statuses.at(utime);
    table.text(status == nullptr ? "" : nameOf(status->mode));
    table.endRow();
  }
};

}  // namespace

CsvFile writeVehicleTable(const Flight& flight, const std::string& file) {
  CsvTable table(file, {"time (s)", "utime (us)", "frame", "vehicle", "tracked", "x (m)", "y (m)",
                        "z (m)", "vx (m/s)", "vy (m/s)", "vz (m/s)", "goal_x (m)", "goal_y (m)",
                        "goal_z (m)", "command_vx (m/s)", "command_vy (m/s)", "mode"});
  std::vector<Track> tracks(flight.vehicles.begin(), flight.vehicles.end());
  for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
    for (Track& track : tracks) {
      track.row(table, flight, frame);
    }
  }
  table.finish();
  CsvFile result;
  result.file = file;
  result.rows = table.rows() - 1;
  return result;
}

}  // namespace roundabout::logs
