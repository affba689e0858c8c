#pragma once

#include <string>
#include <vector>

#include "common/config/experiment.h"

namespace roundabout::config {

/// Reads an experiment file, applies the overrides ("sim.pacing=real_time", "vehicles.0.name=hex1";
/// values are YAML) and checks everything that can be checked without other files. A relative
/// weights path in planner.policy is made absolute against the experiment file's folder. Throws
/// core::StartupError: missing file, not YAML, unknown key (with the nearest known one), wrong
/// type, value out of range, names that are double or not fit for a channel. `where` is FILE:LINE,
/// or "--set KEY" for overrides.
Experiment readExperiment(const std::string& path, const std::vector<std::string>& overrides = {});

/// As readExperiment, from text; `name` stands for the file in errors.
Experiment parseExperiment(const std::string& yaml, const std::string& name,
                           const std::vector<std::string>& overrides = {});

/// The whole experiment, defaults included, as YAML that reads back to the same struct.
std::string toYaml(const Experiment& experiment);

}  // namespace roundabout::config
