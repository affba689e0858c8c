#include "planner/policy_tools/info.h"

#include <ostream>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ostr.h>

#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::planner {

void printWeightsInfo(const std::string& path, std::ostream& out) {
  const nn::TensorFile file = nn::readSafetensors(path);
  for (const auto& [key, value] : file.metadata) {
    out << fmt::format("{:<18}{}\n", key, value);
  }
  std::size_t parameters = 0;
  out << '\n';
  for (const auto& [name, tensor] : file.tensors) {
    out << fmt::format("{:<18}{:<12}{:>8}\n", name, nn::shapeText(tensor.shape),
                       tensor.values.size());
    parameters += tensor.values.size();
  }
  out << fmt::format("{:<18}{:>20}\n", "parameters", parameters);
  toGa3cCadrlWeights(file, path);
}

}  // namespace roundabout::planner
