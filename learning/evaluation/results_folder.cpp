#include "learning/evaluation/results_folder.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/core/error.h"

namespace roundabout::learning {

namespace {

namespace fs = std::filesystem;

constexpr const char* kTitles =
    "policy,agents,case,outcome,steps,mean_extra_time_s,closest_separation_m,decisions,hard,static,"
    "look_ahead,breaker,step_aside,group\n";

// Policies and groups may have commas in their names.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char character : text) {
    quoted += character == '"' ? "\"\"" : std::string(1, character);
  }
  return quoted + "\"";
}

std::string keyOf(const Evaluation& evaluation, const Place& place) {
  const CaseGroup& group = evaluation.suite.groups[place.group];
  return fmt::format("{},{},{},", cell(evaluation.contestants[place.contestant].title()),
                     group.cases[place.number].agents.size(), place.number);
}

bool parseOutcome(const std::string& text, Outcome& outcome) {
  for (const Outcome each : {Outcome::kAllAtGoal, Outcome::kCollision, Outcome::kStuck}) {
    if (text == nameOf(each)) {
      outcome = each;
      return true;
    }
  }
  return false;
}

bool parseRow(const std::string& line, const std::string& key, EpisodeResult& result) {
  if (!line.starts_with(key)) {
    return false;
  }
  std::array<std::string, 4 + kShieldLayers> cells;
  std::istringstream rest(line.substr(key.size()));
  for (std::string& each : cells) {
    if (!std::getline(rest, each, ',')) {
      return false;
    }
  }
  const auto number = [](const std::string& text, auto& value) {
    char* end = nullptr;
    value = static_cast<std::decay_t<decltype(value)>>(std::strtod(text.c_str(), &end));
    return !text.empty() && *end == '\0';
  };
  bool layers = true;
  for (std::size_t i = 1; i < kShieldLayers; ++i) {
    layers = layers && number(cells[4 + i], result.layers[i]);
  }
  return parseOutcome(cells[0], result.outcome) && number(cells[1], result.steps) &&
         number(cells[2], result.mean_extra_time_s) &&
         number(cells[3], result.closest_separation_m) && number(cells[4], result.decisions) &&
         layers;
}

/// "none", or "one with other policies, rules"
std::string differenceOf(const nlohmann::json& before, const nlohmann::json& run) {
  if (!before.is_object()) {
    return "none";
  }
  std::vector<std::string> keys;
  for (const auto& [key, value] : run.items()) {
    if (!before.contains(key) || before[key] != value) {
      keys.push_back(key);
    }
  }
  return fmt::format("one with other {}", fmt::join(keys, ", "));
}

}  // namespace

ResultsFolder::ResultsFolder(const fs::path& folder, const nlohmann::json& run, bool resume,
                             const Evaluation& evaluation)
    : folder_(folder) {
  std::error_code error;
  const fs::path run_file = folder_ / "run.json";
  const bool there = fs::exists(folder_, error) && !fs::is_empty(folder_, error);
  if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
    throw core::StartupError(folder_.string(), "--out", "a folder", "a file");
  }
  if (there && !resume) {
    throw core::StartupError(folder_.string(), "--out",
                             "a folder that is new or empty (or --resume)", "one with files in it");
  }
  if (there) {
    std::ifstream in(run_file);
    const nlohmann::json before = nlohmann::json::parse(in, nullptr, false);
    if (before != run) {
      throw core::StartupError(run_file.string(), "--resume", "the run that was asked for",
                               differenceOf(before, run));
    }
    readFinished(evaluation);
  }
  fs::create_directories(folder_, error);
  if (!there) {
    std::ofstream(run_file) << run.dump(2) << '\n';
  }
  const bool has_rows = !finished_.empty();
  cases_.open(folder_ / "cases.csv", has_rows ? std::ios::app : std::ios::trunc);
  if (!has_rows) {
    cases_ << kTitles << std::flush;
  }
  if (!cases_) {
    throw core::StartupError(folder_.string(), "--out", "a folder that can be written to",
                             error ? error.message() : "one that cannot");
  }
}

void ResultsFolder::readFinished(const Evaluation& evaluation) {
  const fs::path file = folder_ / "cases.csv";
  std::ifstream in(file);
  std::string line;
  // Without its titles the file was being begun when the run was stopped, and begins anew.
  if (!std::getline(in, line) || line + "\n" != kTitles) {
    return;
  }
  std::uintmax_t whole = line.size() + 1;
  while (finished_.size() < evaluation.cases() && std::getline(in, line) && !in.eof()) {
    EpisodeResult result;
    if (!parseRow(line, keyOf(evaluation, placeOf(evaluation, finished_.size())), result)) {
      throw core::StartupError(fmt::format("{}:{}", file.string(), finished_.size() + 2), "row",
                               "the next case of this run", "\"" + line + "\"");
    }
    finished_.push_back(result);
    whole += line.size() + 1;
  }
  in.close();
  // A row without its end was being written.
  std::error_code error;
  fs::resize_file(file, whole, error);
  if (error) {
    throw core::StartupError(file.string(), "--resume", "a file that can be written to",
                             error.message());
  }
}

void ResultsFolder::append(const Evaluation& evaluation, std::size_t row,
                           const EpisodeResult& result) {
  const Place place = placeOf(evaluation, row);
  finished_.push_back(result);
  // As it will be read again: a resumed run has the same summary.
  finished_.back().mean_extra_time_s = std::round(1e6 * result.mean_extra_time_s) / 1e6;
  finished_.back().closest_separation_m = std::round(1e6 * result.closest_separation_m) / 1e6;
  const std::span<const long> changed = std::span(result.layers).subspan(1);
  cases_ << fmt::format("{}{},{},{:.6f},{:.6f},{},{},{}\n", keyOf(evaluation, place),
                        nameOf(result.outcome), result.steps, result.mean_extra_time_s,
                        result.closest_separation_m, result.decisions, fmt::join(changed, ","),
                        cell(evaluation.suite.groups[place.group].name))
         << std::flush;
  if (!cases_) {
    throw core::StartupError((folder_ / "cases.csv").string(), "row", "room on the disk", "none");
  }
}

}  // namespace roundabout::learning
