#include "planner/policy_tools/info.h"

#include <algorithm>
#include <ostream>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ostr.h>

#include "planner/policies/cadrl/published.h"
#include "planner/policies/cadrl/weights.h"
#include "planner/policies/drl_maca/weights.h"
#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::planner {

namespace {

constexpr std::size_t kNameColumns = 18;

/// As the policy that the file names would: throws core::StartupError.
void checkWeights(const nn::TensorFile& file, const std::string& path) {
  const auto entry = file.metadata.find("architecture");
  const std::string architecture = entry == file.metadata.end() ? "" : entry->second;
  if (architecture == kCadrlArchitecture || isPublishedCadrl(file)) {
    readCadrlWeights(path);
  } else if (architecture == kDrlMacaArchitecture) {
    toDrlMacaWeights(file, path);
  } else {
    toGa3cCadrlWeights(file, path);
  }
}

}  // namespace

void printWeightsInfo(const std::string& path, std::ostream& out) {
  const nn::TensorFile file = nn::readSafetensors(path);
  for (const auto& [key, value] : file.metadata) {
    out << fmt::format("{:<18}{}\n", key, value);
  }
  std::size_t parameters = 0;
  std::size_t width = kNameColumns;
  for (const auto& [name, tensor] : file.tensors) {
    width = std::max(width, name.size() + 1);
  }
  out << '\n';
  for (const auto& [name, tensor] : file.tensors) {
    out << fmt::format("{:<{}}{:<12}{:>8}\n", name, width, nn::shapeText(tensor.shape),
                       tensor.values.size());
    parameters += tensor.values.size();
  }
  out << fmt::format("{:<{}}{:>20}\n", "parameters", width, parameters);
  checkWeights(file, path);
}

}  // namespace roundabout::planner
