#include "cli/doctor/doctor_command.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "cli/doctor/examination.h"
#include "cli/doctor/mocap_examination.h"
#include "common/bus/lcm_bus.h"
#include "common/config/experiment_file.h"

namespace roundabout::cli {

namespace {

const char* wordOf(Health health) {
  switch (health) {
    case Health::kWell:
      return "ok";
    case Health::kWorthKnowing:
      return "note";
    case Health::kWrong:
      return "WRONG";
  }
  return "";
}

int doctor(const std::string& experiment_file, const std::string& lcm_url) {
  const std::string url = bus::resolveUrl(lcm_url);
  fmt::print("{}\n", url);
  std::vector<Finding> findings = examine(url);
  if (!experiment_file.empty()) {
    for (Finding& finding : examineMocap(config::readExperiment(experiment_file, {}))) {
      findings.push_back(std::move(finding));
    }
  }
  int wrong = 0;
  for (const Finding& finding : findings) {
    fmt::print("{:<6} {:<19} {}\n", wordOf(finding.health), finding.what, finding.found);
    if (!finding.mend.empty()) {
      fmt::print("       {:<19} {}\n", "", finding.mend);
    }
    wrong += finding.health == Health::kWrong ? 1 : 0;
  }
  return wrong == 0 ? 0 : 1;
}

}  // namespace

void addDoctorCommand(CLI::App& app, int& exit_status) {
  CLI::App* command =
      app.add_subcommand("doctor", "What is wrong with this machine, and what mends it");
  auto file = std::make_shared<std::string>();
  command->add_option("file", *file, "Experiment file: looks for its motion-capture system, too");
  auto lcm_url = std::make_shared<std::string>();
  command->add_option("--lcm-url", *lcm_url, "Default: LCM_DEFAULT_URL");
  command->callback([file, lcm_url, &exit_status] { exit_status = doctor(*file, *lcm_url); });
}

}  // namespace roundabout::cli
