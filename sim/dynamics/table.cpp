#include "sim/dynamics/table.h"

#include "common/core/error.h"
#include "sim/dynamics/ground_robot/ground_robot.h"
#include "sim/dynamics/multirotor/multirotor.h"
#include "sim/dynamics/unicycle/unicycle.h"

namespace roundabout::sim {

namespace {

constexpr DynamicsEntry kTable[] = {
    {"unicycle", &Unicycle::make},
    {"multirotor", &Multirotor::make},
    {"ground_robot", &GroundRobot::make},
};

}  // namespace

std::span<const DynamicsEntry> dynamicsTable() { return kTable; }

std::unique_ptr<Dynamics> makeDynamics(const config::Vehicle& vehicle, const config::Sim& sim,
                                       const config::Start& start, const std::string& file) {
  std::string names;
  for (const DynamicsEntry& entry : kTable) {
    if (entry.name == vehicle.model) {
      return entry.make(vehicle, sim, start);
    }
    names += (names.empty() ? "" : " or ") + std::string(entry.name);
  }
  throw core::StartupError(file, "vehicles." + vehicle.name + ".model", names,
                           "\"" + vehicle.model + "\"");
}

}  // namespace roundabout::sim
