#pragma once

#include <filesystem>
#include <string>

#include "planner/nn/safetensors.h"
#include "tests/support/drl_maca_weights.h"

namespace roundabout::test {

/// An experiment whose vehicles fly by a network for scans that only seeks its goal: two, in lanes
/// of their own. Writes the network into `folder`; `defaults` is appended to vehicle_defaults.
inline std::string twoLanes(const std::filesystem::path& folder, const std::string& defaults) {
  const std::string weights = folder / "drl_maca.safetensors";
  planner::nn::writeSafetensors(weights, goalSeekingDrlMaca());
  return "room: {min_m: [-5, -5, 0], max_m: [5, 5, 3]}\n"
         "vehicle_defaults: {preferred_speed_mps: 1.0" +
         defaults +
         "}\n"
         "vehicles:\n"
         "  - {name: hex1, start: {position_m: [-2, -2]}}\n"
         "  - {name: hex2, start: {position_m: [-2, 2]}}\n"
         "planner: {policy: \"drl_maca:" +
         weights +
         "\"}\n"
         "fleet: {assignment: in_order}\n"
         "mission:\n"
         "  - take_off\n"
         "  - formation: {name: ahead, points: [[2, -2], [2, 2]]}\n"
         "  - land\n";
}

}  // namespace roundabout::test
