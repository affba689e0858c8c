#include "cli/flight_folder.h"

#include <ctime>
#include <fstream>

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"

namespace roundabout::cli {

namespace {

std::filesystem::path freeFolder(const std::string& experiment) {
  const std::string name =
      fmt::format("{}-{:%Y%m%d-%H%M%S}", experiment, fmt::localtime(std::time(nullptr)));
  std::filesystem::path folder = std::filesystem::path("out") / name;
  for (int again = 2; std::filesystem::exists(folder); ++again) {
    folder = std::filesystem::path("out") / fmt::format("{}-{}", name, again);
  }
  return folder;
}

}  // namespace

std::filesystem::path makeFlightFolder(const config::Experiment& experiment,
                                       const std::string& wanted) {
  const std::filesystem::path folder = std::filesystem::absolute(
      wanted.empty() ? freeFolder(experiment.name) : std::filesystem::path(wanted));
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error)) {
    throw core::StartupError(folder.string(), "--out", "a folder that is new or empty",
                             "one with files in it");
  }
  std::filesystem::create_directories(folder, error);
  std::ofstream file(folder / "experiment.yaml");
  file << config::toYaml(experiment);
  file.close();
  if (!file) {
    throw core::StartupError(folder.string(), "--out", "a folder that can be written to",
                             error ? error.message() : "one that cannot");
  }
  return folder;
}

}  // namespace roundabout::cli
