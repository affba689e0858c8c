#include "planner/policy_tools/policy_commands.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "planner/nn/safetensors.h"
#include "planner/policies/cadrl/published.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policy_tools/average_weights.h"
#include "planner/policy_tools/gates/figure.h"
#include "planner/policy_tools/import_checkpoint.h"
#include "planner/policy_tools/info.h"
#include "planner/policy_tools/query.h"

namespace roundabout::planner {

namespace {

nn::TensorFile importPublished(const std::string& path, OthersOrder order) {
  return path.ends_with(".safetensors") ? importPublishedCadrl(nn::readSafetensors(path), path)
                                        : importCheckpoint(path, order);
}

void addImport(CLI::App& policy) {
  struct Arguments {
    std::string published;
    std::string output;
    std::string order = std::string(nameOf(OthersOrder::kClosestLast));
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      policy.add_subcommand("import", "Turn a published network into a weight file");
  command
      ->add_option("PUBLISHED", arguments->published,
                   "A TensorFlow checkpoint without \".index\", or SA-CADRL's .safetensors")
      ->required();
  command->add_option("-o,--output", arguments->output, "FILE.safetensors")->required();
  const auto orders = othersOrderNames();
  command
      ->add_option(
          "--order", arguments->order,
          "In which order a checkpoint's network is fed the others; the published ones were "
          "trained closest_last")
      ->check(CLI::IsMember(std::vector<std::string>(orders.begin(), orders.end())))
      ->capture_default_str();
  command->callback([arguments] {
    nn::writeSafetensors(
        arguments->output,
        importPublished(arguments->published, othersOrderNamed(arguments->order).value()));
  });
}

void addInfo(CLI::App& policy) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = policy.add_subcommand("info", "Say what a weight file holds");
  command->add_option("FILE", *path, "FILE.safetensors")->required();
  command->callback([path] { printWeightsInfo(*path, std::cout); });
}

void addAverage(CLI::App& policy) {
  struct Arguments {
    std::vector<std::string> paths;
    std::string output;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = policy.add_subcommand(
      "average", "Write the mean of a network's weights in several states of its training");
  command->add_option("FILE", arguments->paths, "FILE.safetensors; two or more")->required();
  command->add_option("-o,--output", arguments->output, "FILE.safetensors")->required();
  command->callback(
      [arguments] { nn::writeSafetensors(arguments->output, averageWeights(arguments->paths)); });
}

void addQuery(CLI::App& policy) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = policy.add_subcommand(
      "query", "Evaluate observations: JSON lines from standard input, back with their result");
  command->add_option("FILE", *path, "FILE.safetensors")->required();
  command->callback([path] {
    if (queryPolicy(*path, std::cin, std::cout, std::cerr) > 0) {
      throw CLI::RuntimeError(1);
    }
  });
}

std::ofstream fileToWrite(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) {
    throw core::StartupError(path.string(), "gates", "a file that can be written",
                             std::strerror(errno));
  }
  return file;
}

void analyseGatesOf(const std::string& path, const std::vector<std::string>& scenes,
                    const std::string& folder) {
  const auto weights = readGa3cCadrlWeights(path);
  std::vector<GateAnalysis> analyses;
  for (const std::string& scene : scenes) {
    analyses.push_back(analyseGates(*weights, path, readGateScene(scene)));
  }
  writeGatesCsv(analyses, std::cout);
  if (!folder.empty()) {
    std::filesystem::create_directories(folder);
    std::ofstream csv = fileToWrite(std::filesystem::path(folder) / "gates.csv");
    writeGatesCsv(analyses, csv);
    drawGates(analyses, std::filesystem::path(folder) / "gates");
  }
}

void addGates(CLI::App& policy) {
  struct Arguments {
    std::string path;
    std::vector<std::string> scenes;
    std::string folder;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = policy.add_subcommand(
      "gates", "Split the LSTM's input gate into its parts as each other agent is read");
  command->add_option("FILE", arguments->path, "FILE.safetensors")->required();
  command->add_option("--scene", arguments->scenes, "SCENE.yaml; one row of the figure each")
      ->required();
  command->add_option("--out", arguments->folder,
                      "Folder for gates.csv, gates.png and gates.svg; without it only the table is "
                      "printed");
  command->callback(
      [arguments] { analyseGatesOf(arguments->path, arguments->scenes, arguments->folder); });
}

}  // namespace

void addPolicyCommands(CLI::App& parent) {
  CLI::App* policy = parent.add_subcommand("policy", "Weight files of learned policies");
  policy->require_subcommand(1);
  addImport(*policy);
  addInfo(*policy);
  addAverage(*policy);
  addQuery(*policy);
  addGates(*policy);
}

}  // namespace roundabout::planner
