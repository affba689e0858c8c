#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/config/experiment.h"
#include "planner/policy.h"

namespace roundabout::planner {

/// What a policy may be made from.
struct PolicyOptions {
  std::string weights;  ///< path; empty: the policy's own default, if it has one
  config::Orca orca;
  std::string where = "experiment";  ///< who asks, for errors: the experiment file
  bool with_value = true;            ///< false: leave out what only Decision::value needs
};

struct PolicyEntry {
  std::string_view name;
  bool has_weights;
  std::string_view shipped_weights;  ///< path; empty: it flies only with weights that are named
  std::unique_ptr<Policy> (*make)(const PolicyOptions& options);
};

/// Every policy there is; a new one is a sub-folder and a line in table.cpp.
std::span<const PolicyEntry> policyTable();

/// The path of the weights that a specification NAME or NAME:WEIGHTS means; empty if there are
/// none.
std::string weightsOf(const std::string& specification);

/// Makes the policy of a specification NAME or NAME:WEIGHTS.
/// Throws core::StartupError if the name is unknown (with the nearest known one), weights are
/// missing or superfluous, or do not load.
std::unique_ptr<Policy> makePolicy(const std::string& specification, const PolicyOptions& options);

}  // namespace roundabout::planner
