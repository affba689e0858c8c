#include "planner/policies/table.h"

#include <array>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/config/words.h"
#include "common/core/error.h"
#include "planner/policies/cadrl/cadrl.h"
#include "planner/policies/drl_maca/drl_maca.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/non_cooperative/non_cooperative.h"
#include "planner/policies/orca/orca.h"
#include "planner/policies/static/static.h"

namespace roundabout::planner {

namespace {

constexpr std::array kPolicies = {
    PolicyEntry{"ga3c_cadrl", true, ROUNDABOUT_POLICIES "/ga3c_cadrl/weights/default.safetensors",
                makeGa3cCadrl},
    PolicyEntry{"cadrl", true, "", makeCadrl},
    PolicyEntry{"drl_maca", true, "", makeDrlMaca},
    PolicyEntry{"orca", false, "", makeOrca},
    PolicyEntry{"non_cooperative", false, "", makeNonCooperative},
    PolicyEntry{"static", false, "", makeStatic},
};

const PolicyEntry& entryOf(const std::string& name, const PolicyOptions& options) {
  std::vector<std::string> known;
  for (const PolicyEntry& entry : kPolicies) {
    if (entry.name == name) {
      return entry;
    }
    known.emplace_back(entry.name);
  }
  const std::string meant = config::nearest(name, known);
  throw core::StartupError(
      options.where, "planner.policy", fmt::format("one of {}", fmt::join(known, ", ")),
      config::inQuotes(name) +
          (meant.empty() ? "" : fmt::format(" (did you mean {}?)", config::inQuotes(meant))));
}

}  // namespace

std::span<const PolicyEntry> policyTable() { return kPolicies; }

std::string weightsOf(const std::string& specification) {
  const std::size_t colon = specification.find(':');
  if (colon != std::string::npos) {
    return specification.substr(colon + 1);
  }
  for (const PolicyEntry& entry : kPolicies) {
    if (entry.name == specification) {
      return std::string(entry.shipped_weights);
    }
  }
  return {};
}

std::unique_ptr<Policy> makePolicy(const std::string& specification, const PolicyOptions& options) {
  const std::size_t colon = specification.find(':');
  const PolicyEntry& entry = entryOf(specification.substr(0, colon), options);
  PolicyOptions its_options = options;
  if (entry.has_weights && (colon != std::string::npos || its_options.weights.empty())) {
    its_options.weights = weightsOf(specification);
  }
  if (entry.has_weights && its_options.weights.empty()) {
    throw core::StartupError(options.where, "planner.policy",
                             fmt::format("\"{}:WEIGHTS\"", entry.name),
                             config::inQuotes(specification));
  }
  if (!entry.has_weights && colon != std::string::npos) {
    throw core::StartupError(options.where, "planner.policy",
                             fmt::format("\"{}\", which has no weights", entry.name),
                             config::inQuotes(specification));
  }
  return entry.make(its_options);
}

}  // namespace roundabout::planner
