#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

struct DynamicsEntry {
  std::string_view name;
  std::unique_ptr<Dynamics> (*make)(const config::Vehicle& vehicle, const config::Sim& sim,
                                    const config::Start& start);
};

/// Every vehicle model there is; a new one is a sub-folder and a line in table.cpp.
std::span<const DynamicsEntry> dynamicsTable();

/// Makes the model that vehicle.model names, at rest at its start. Throws core::StartupError if
/// there is no such model; `file` is named in it.
std::unique_ptr<Dynamics> makeDynamics(const config::Vehicle& vehicle, const config::Sim& sim,
                                       const config::Start& start, const std::string& file);

}  // namespace roundabout::sim
