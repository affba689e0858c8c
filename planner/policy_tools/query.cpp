#include "planner/policy_tools/query.h"

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>
#include <span>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::planner {

namespace {

using core::StartupError;
using Json = nlohmann::ordered_json;

/// One line as an observation; errors name the line and the field.
class LineParser {
 public:
  LineParser(int line_number, int max_others)
      : where_(fmt::format("line {}", line_number)), max_others_(max_others) {}

  Json parse(const std::string& line, Observation& observation) const {
    Json record = Json::parse(line, nullptr, false);
    if (!record.is_object()) {
      throw StartupError(where_, "observation", "a JSON object",
                         record.is_discarded() ? "no JSON" : record.type_name());
    }
    readNumbers("ego", field(record, "ego"), observation.ego);
    const Json& others = field(record, "others");
    if (!others.is_array() || others.size() > static_cast<std::size_t>(max_others_)) {
      throw StartupError(where_, "others", fmt::format("a list of at most {}", max_others_),
                         sizeText(others));
    }
    if (field(record, "num_other_agents") != others.size()) {
      throw StartupError(where_, "num_other_agents", fmt::format("{}, as in others", others.size()),
                         record["num_other_agents"].dump());
    }
    observation.others.resize(others.size());
    for (std::size_t i = 0; i < others.size(); ++i) {
      readNumbers(fmt::format("others[{}]", i), others[i], observation.others[i]);
    }
    return record;
  }

 private:
  const Json& field(const Json& record, const std::string& key) const {
    if (!record.contains(key)) {
      throw StartupError(where_, key, "to be there", "nothing");
    }
    return record[key];
  }

  static std::string sizeText(const Json& value) {
    return value.is_array() ? fmt::format("a list of {}", value.size()) : value.dump();
  }

  void readNumbers(const std::string& what, const Json& value, std::span<float> numbers) const {
    const std::string expected = fmt::format("a list of {} numbers", numbers.size());
    if (!value.is_array() || value.size() != numbers.size()) {
      throw StartupError(where_, what, expected, sizeText(value));
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (!value[i].is_number() || !std::isfinite(value[i].get<float>())) {
        throw StartupError(where_, what, expected, value.dump());
      }
      numbers[i] = value[i].get<float>();
    }
  }

  std::string where_;
  int max_others_;
};

}  // namespace

int queryPolicy(const std::string& weights_path, std::istream& in, std::ostream& out,
                std::ostream& errors) {
  Ga3cCadrlNetwork network(readGa3cCadrlWeights(weights_path));
  int bad_lines = 0;
  std::string line;
  for (int line_number = 1; std::getline(in, line); ++line_number) {
    try {
      Observation observation;
      Json record = LineParser(line_number, network.weights()->max_others).parse(line, observation);
      const Ga3cCadrlNetwork::Output output = network.evaluate(observation);
      record["probs"] = output.probabilities;
      record["value"] = output.value;
      record["action"] = output.best_action;
      out << record.dump() << '\n';
    } catch (const StartupError& error) {
      errors << error.what() << '\n';
      ++bad_lines;
    }
  }
  return bad_lines;
}

}  // namespace roundabout::planner
