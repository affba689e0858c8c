#include "fleet/mission.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "fleet/formations/letter.h"
#include "fleet/goal_check.h"

namespace roundabout::fleet {

namespace {

constexpr std::size_t kLongestText = 200;
// Goal ids tell the file's steps, and the landing after a failed one, from live steps.
constexpr std::size_t kMostFileSteps = 998;

}  // namespace

bool needsAir(Verb verb) { return verb == Verb::kFormation || verb == Verb::kGoTo; }

MissionReader::MissionReader(const config::Experiment& experiment) : experiment_(experiment) {}

double MissionReader::stayS(const config::MissionStep& asked) const {
  return asked.seconds >= 0.0 ? asked.seconds : experiment_.fleet.hold_s;
}

StepsOrRefusal MissionReader::read(const config::MissionStep& asked) const {
  const auto single = [](Verb verb, double seconds) {
    Step step;
    step.verb = verb;
    step.seconds = seconds;
    return std::vector<Step>{step};
  };
  if (std::isinf(asked.seconds)) {
    return "seconds is not a finite number";
  }
  if (asked.verb == "take_off") {
    return single(Verb::kTakeOff, 0.0);
  }
  if (asked.verb == "spell") {
    return spell(asked);
  }
  if (asked.verb == "formation") {
    return formation(asked);
  }
  if (asked.verb == "go_to") {
    return goTo(asked);
  }
  if (asked.verb == "hold") {
    return single(Verb::kHold, stayS(asked));
  }
  if (asked.verb == "wait") {
    return single(Verb::kWait, stayS(asked));
  }
  if (asked.verb == "wait_until") {
    return waitUntil(asked);
  }
  if (asked.verb == "land") {
    return single(Verb::kLand, 0.0);
  }
  return fmt::format(
      "\"{}\" is no verb: take_off, spell, formation, go_to, hold, wait, wait_until, "
      "go_on and land are",
      asked.verb);
}

StepsOrRefusal MissionReader::spell(const config::MissionStep& asked) const {
  if (asked.text.empty() || asked.text.size() > kLongestText) {
    return fmt::format("a text of {} characters cannot be spelled: 1 to {} can", asked.text.size(),
                       kLongestText);
  }
  std::vector<Step> steps;
  for (const char character : asked.text) {
    Step step;
    step.seconds = stayS(asked);
    if (character == ' ') {
      step.verb = Verb::kWait;
      steps.push_back(step);
      continue;
    }
    PointsOrRefusal points = letterPoints(experiment_, font_, character);
    if (const auto* refusal = std::get_if<std::string>(&points)) {
      return *refusal;
    }
    step.verb = Verb::kFormation;
    step.name = std::string(1, character);
    step.points_m = std::move(std::get<std::vector<Eigen::Vector3d>>(points));
    step.at_own_heights = ownGlyph(experiment_, character) == nullptr;
    steps.push_back(std::move(step));
  }
  return steps;
}

StepsOrRefusal MissionReader::formation(const config::MissionStep& asked) const {
  if (asked.points_m.empty()) {
    return "a formation without points";
  }
  if (auto refusal = refuseGoals(experiment_, asked.points_m)) {
    return *refusal;
  }
  Step step;
  step.verb = Verb::kFormation;
  step.name = asked.text.empty() ? "formation" : asked.text;
  step.points_m = asked.points_m;
  step.seconds = stayS(asked);
  return std::vector<Step>{step};
}

StepsOrRefusal MissionReader::goTo(const config::MissionStep& asked) const {
  Step step;
  step.verb = Verb::kGoTo;
  std::string known;
  for (std::size_t i = 0; i < experiment_.vehicles.size(); ++i) {
    known += (i == 0 ? "" : ", ") + experiment_.vehicles[i].name;
    if (experiment_.vehicles[i].name == asked.vehicle) {
      step.vehicle = i;
    }
  }
  if (experiment_.vehicles[step.vehicle].name != asked.vehicle) {
    return fmt::format("there is no vehicle \"{}\": {} are", asked.vehicle, known);
  }
  if (asked.points_m.size() != 1) {
    return fmt::format("go_to takes one point, not {}", asked.points_m.size());
  }
  if (auto refusal = refuseGoals(experiment_, asked.points_m)) {
    return *refusal;
  }
  step.points_m = asked.points_m;
  return std::vector<Step>{step};
}

StepsOrRefusal MissionReader::waitUntil(const config::MissionStep& asked) {
  Step step;
  step.verb = Verb::kWaitUntil;
  if (asked.text.empty() && asked.seconds >= 0.0) {
    step.seconds = asked.seconds;
  } else if (asked.text == "formed") {
    step.event = Event::kFormed;
  } else if (asked.text == "go_on") {
    step.event = Event::kGoOn;
  } else {
    return fmt::format(
        "\"{}\" is nothing to wait for: formed, go_on, or seconds since the take-off are",
        asked.text);
  }
  return std::vector<Step>{step};
}

std::vector<Step> MissionReader::readFile() const {
  std::vector<Step> steps;
  bool in_air =
      std::none_of(experiment_.vehicles.begin(), experiment_.vehicles.end(), config::flies);
  const bool drives = in_air;
  for (std::size_t k = 0; k < experiment_.mission.size(); ++k) {
    const config::MissionStep& asked = experiment_.mission[k];
    StepsOrRefusal read_steps = read(asked);
    const std::string what = fmt::format("mission[{}].{}", k, asked.verb);
    if (const auto* refusal = std::get_if<std::string>(&read_steps)) {
      throw core::StartupError(experiment_.file, what, "something that can be flown", *refusal);
    }
    const auto& expanded = std::get<std::vector<Step>>(read_steps);
    const Verb verb = expanded.front().verb;
    if (!in_air && (needsAir(verb) || verb == Verb::kHold || asked.verb == "spell")) {
      throw core::StartupError(experiment_.file, what, "take_off before anything in the air",
                               "none");
    }
    in_air = drives || verb == Verb::kTakeOff || (in_air && verb != Verb::kLand);
    if (steps.size() + expanded.size() > kMostFileSteps) {
      throw core::StartupError(experiment_.file, what,
                               fmt::format("at most {} steps and letters", kMostFileSteps), "more");
    }
    steps.insert(steps.end(), expanded.begin(), expanded.end());
  }
  return steps;
}

}  // namespace roundabout::fleet
