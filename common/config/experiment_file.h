#pragma once

#include <string>
#include <vector>

#include "common/config/experiment.h"

namespace roundabout::config {

/// Reads an experiment file, applies the overrides ("sim.pacing=real_time", "vehicles.0.name=hex1";
/// values are YAML) and checks everything that can be checked without other files. A relative
/// weights path in planner.policy is made absolute: against the experiment file's folder, or the
/// current one if an override set it. Points written as [x, y] get the vehicles' height. Throws
/// core::StartupError: missing file, not YAML, unknown or doubled key (with the nearest known one),
/// wrong type, value out of range, keys that contradict each other. `where` is FILE:LINE, or
/// "--set KEY" for overrides. docs/experiment_file.md explains every key.
Experiment readExperiment(const std::string& path, const std::vector<std::string>& overrides = {});

/// As readExperiment, from text; `name` stands for the file in errors.
Experiment parseExperiment(const std::string& yaml, const std::string& name,
                           const std::vector<std::string>& overrides = {});

/// Reads a file whose one key is `mission`, as in an experiment file, for a fleet that is told by
/// message: points need their height. Throws core::StartupError as readExperiment() does.
std::vector<MissionStep> readMissionFile(const std::string& path);

/// The whole experiment, defaults included, as YAML that reads back to the same struct.
std::string toYaml(const Experiment& experiment);

}  // namespace roundabout::config
