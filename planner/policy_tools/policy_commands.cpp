#include "planner/policy_tools/policy_commands.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "planner/nn/safetensors.h"
#include "planner/policies/cadrl/published.h"
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

}  // namespace

void addPolicyCommands(CLI::App& parent) {
  CLI::App* policy = parent.add_subcommand("policy", "Weight files of learned policies");
  policy->require_subcommand(1);
  addImport(*policy);
  addInfo(*policy);
  addQuery(*policy);
}

}  // namespace roundabout::planner
