#include "common/config/experiment_file.h"

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

void readPointsFiles(Experiment& experiment, const std::filesystem::path& folder,
                     const Refuse& refuse) {
  for (std::size_t i = 0; i < experiment.mission.size(); ++i) {
    MissionStep& step = experiment.mission[i];
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

  readPointsFiles(experiment, std::filesystem::path(name).parent_path(), refuse);
  orientObstacles(experiment.obstacles);
  fillHeights(experiment, refuse);
  checkConsistency(experiment, refuse);
  experiment.planner.policy = withAbsoluteWeights(experiment.planner.policy,
                                                  document.overridden("planner.policy")
                                                      ? std::filesystem::path()
                                                      : std::filesystem::path(name).parent_path());
  return experiment;
}

std::string toYaml(const Experiment& experiment) {
  Experiment copy = experiment;  // describe() takes structs that a reader could fill
  Writer writer;
  writer.write(copy);
  return writer.text();
}

}  // namespace roundabout::config
