#include "common/config/experiment_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/config/checks.h"
#include "common/config/document.h"
#include "common/config/obstacles.h"
#include "common/config/points_file.h"
#include "common/config/reader.h"
#include "common/config/writer.h"

namespace roundabout::config {

namespace {

// "ga3c_cadrl:weights/x.safetensors": what stands in a file is meant from the file's folder, what
// is typed from the folder one is in.
std::string withAbsoluteWeights(const std::string& policy, const std::filesystem::path& folder) {
  const std::size_t colon = policy.find(':');
  if (colon == std::string::npos) {
    return policy;
  }
  const std::filesystem::path weights = folder / policy.substr(colon + 1);
  return policy.substr(0, colon + 1) +
         std::filesystem::absolute(weights).lexically_normal().string();
}

std::string fromFolder(const std::string& file, const std::filesystem::path& folder) {
  return file.empty() ? file : std::filesystem::absolute(folder / file).lexically_normal().string();
}

void readPointsFiles(std::vector<MissionStep>& mission, const std::filesystem::path& folder,
                     const Refuse& refuse) {
  for (std::size_t i = 0; i < mission.size(); ++i) {
    MissionStep& step = mission[i];
    if (step.points_file.empty()) {
      continue;
    }
    if (!step.points_m.empty()) {
      refuse("mission[" + std::to_string(i) + "].formation", "points or a points_file", "both");
    }
    step.points_m = readPointsFile((folder / step.points_file).string());
    step.points_file.clear();
  }
}

}  // namespace

Experiment readExperiment(const std::string& path, const std::vector<std::string>& overrides) {
  return parseExperiment(textOfFile(path, "experiment"), path, overrides);
}

std::vector<MissionStep> readMissionFile(const std::string& path) {
  const Document document(textOfFile(path, "mission"), path, {});
  std::vector<MissionStep> mission;
  Reader reader(document, document.root(), "");
  reader("mission", mission);
  reader.finish();
  const auto refuse = [&](const std::string& key, const std::string& expected,
                          const std::string& found) { document.fail(key, expected, found); };
  readPointsFiles(mission, std::filesystem::path(path).parent_path(), refuse);
  if (mission.empty()) {
    refuse("mission", "at least one step", "none");
  }
  for (std::size_t i = 0; i < mission.size(); ++i) {
    const auto& points_m = mission[i].points_m;
    if (std::any_of(points_m.begin(), points_m.end(),
                    [](const Eigen::Vector3d& point) { return std::isnan(point.z()); })) {
      refuse("mission[" + std::to_string(i) + "]." + mission[i].verb, "points [x, y, z]",
             "one without a height");
    }
  }
  return mission;
}

Experiment parseExperiment(const std::string& yaml, const std::string& name,
                           const std::vector<std::string>& overrides) {
  const Document document(yaml, name, overrides);
  const auto refuse = [&](const std::string& path, const std::string& expected,
                          const std::string& found) { document.fail(path, expected, found); };

  Experiment experiment;
  experiment.file = name;
  experiment.name = std::filesystem::path(name).stem().string();
  Reader reader(document, document.root(), "");
  describe(reader, experiment);
  reader.finish();

  readPointsFiles(experiment.mission, std::filesystem::path(name).parent_path(), refuse);
  orientObstacles(experiment.obstacles);
  orientObstacles(experiment.no_fly_zones);
  fillHeights(experiment, refuse);
  checkConsistency(experiment, refuse);
  const auto folderOf = [&](const char* key) {
    return document.overridden(key) ? std::filesystem::path()
                                    : std::filesystem::path(name).parent_path();
  };
  experiment.planner.policy =
      withAbsoluteWeights(experiment.planner.policy, folderOf("planner.policy"));
  experiment.pedestrians.policy =
      withAbsoluteWeights(experiment.pedestrians.policy, folderOf("pedestrians.policy"));
  experiment.pedestrians.recording.file =
      fromFolder(experiment.pedestrians.recording.file, folderOf("pedestrians.recording.file"));
  return experiment;
}

std::string toYaml(const Experiment& experiment) {
  Experiment copy = experiment;  // describe() takes structs that a reader could fill
  Writer writer;
  writer.write(copy);
  return writer.text();
}

}  // namespace roundabout::config
