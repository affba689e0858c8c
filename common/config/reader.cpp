#include "common/config/reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/config/words.h"

namespace roundabout::config {

namespace {

// The scalar's text as a number, or nothing. Quoted text is text, not a number.
template <class Number>
std::optional<Number> numberIn(const YAML::Node& node) {
  if (!node.IsScalar() || node.Tag() == "!") {
    return std::nullopt;
  }
  std::string_view text = node.Scalar();
  if (text.starts_with('+')) {
    text.remove_prefix(1);
  }
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

std::string foundNumber(const YAML::Node& node) {
  const bool quoted_text = node.IsScalar() && node.Tag() == "!";
  const std::optional<double> number = quoted_text ? std::nullopt : numberIn<double>(node);
  const bool plain = number && std::isfinite(*number);
  return plain ? oneLine(node.Scalar()) : (quoted_text ? "the text " : "") + found(node);
}

std::string anyOf(const std::vector<std::string>& words) {
  return fmt::format("one of {}", fmt::join(words, ", "));
}

}  // namespace

Reader::Reader(const Document& document, const YAML::Node& node, std::string path)
    : document_(document), node_(node), path_(std::move(path)) {
  if (!node_.IsMap()) {
    document_.fail(path_, "a map of keys", found(node_));
  }
  std::set<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) {
      document_.failAt(entry.first.Mark(), path_, "text as a key", found(entry.first));
    }
    if (!keys.insert(entry.first.Scalar()).second) {
      document_.failAt(entry.first.Mark(), pathTo(entry.first.Scalar()), "a key once", "it twice");
    }
  }
}

YAML::Node Reader::take(const char* key) {
  known_.emplace_back(key);
  return std::as_const(node_)[key];
}

std::string Reader::pathTo(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

void Reader::finish() const {
  for (const auto& entry : node_) {
    const std::string& key = entry.first.Scalar();
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) {
      continue;
    }
    const std::string meant = nearest(key, known_);
    document_.failAt(
        entry.first.Mark(), pathTo(key), anyOf(known_),
        fmt::format("{}{}", inQuotes(key),
                    meant.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", meant)));
  }
}

void Reader::read(const YAML::Node& node, const std::string& path, double& value,
                  const Constraint& constraint) {
  const std::optional<double> number = numberIn<double>(node);
  if (!number || !constraint.admits(*number)) {
    document_.fail(path, constraint.expectedNumber("a number"), foundNumber(node));
  }
  value = *number;
}

void Reader::read(const YAML::Node& node, const std::string& path, int& value,
                  const Constraint& constraint) {
  const std::optional<int> number = numberIn<int>(node);
  if (!number || !constraint.admits(static_cast<double>(*number))) {
    document_.fail(path, constraint.expectedNumber("a whole number"), foundNumber(node));
  }
  value = *number;
}

void Reader::read(const YAML::Node& node, const std::string& path, std::uint64_t& value,
                  const Constraint&) {
  const std::optional<std::uint64_t> number = numberIn<std::uint64_t>(node);
  if (!number) {
    document_.fail(path, "a whole number of at least 0", foundNumber(node));
  }
  value = *number;
}

void Reader::read(const YAML::Node& node, const std::string& path, bool& value, const Constraint&) {
  const std::string text = node.IsScalar() && node.Tag() != "!" ? node.Scalar() : "";
  if (text != "true" && text != "false") {
    document_.fail(path, "true or false", found(node));
  }
  value = text == "true";
}

void Reader::read(const YAML::Node& node, const std::string& path, std::string& value,
                  const Constraint& constraint) {
  if (!node.IsScalar() || !constraint.admits(node.Scalar())) {
    document_.fail(path, constraint.expectedText(), found(node));
  }
  value = node.Scalar();
}

void Reader::readCoordinates(const YAML::Node& node, const std::string& path, double* values,
                             std::size_t count, const char* expected) {
  if (!node.IsSequence() || node.size() != count) {
    document_.fail(path, expected, found(node));
  }
  for (std::size_t i = 0; i < count; ++i) {
    read(node[i], path + "[" + std::to_string(i) + "]", values[i], {});
  }
}

void Reader::read(const YAML::Node& node, const std::string& path, Eigen::Vector2d& value,
                  const Constraint&) {
  readCoordinates(node, path, value.data(), 2, "[x, y]");
}

void Reader::read(const YAML::Node& node, const std::string& path, Eigen::Vector3d& value,
                  const Constraint& constraint) {
  if (constraint.height_optional && node.IsSequence() && node.size() == 2) {
    readCoordinates(node, path, value.data(), 2, "[x, y]");
    value.z() = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  readCoordinates(node, path, value.data(), 3,
                  constraint.height_optional ? "[x, y] or [x, y, z]" : "[x, y, z]");
}

void Reader::read(const YAML::Node& node, const std::string& path, MissionStep& step,
                  const Constraint&) {
  const bool bare = node.IsScalar();
  if (!bare && !(node.IsMap() && node.size() == 1 && node.begin()->first.IsScalar())) {
    document_.fail(path, "a verb, or a map with one verb as its key", found(node));
  }
  step.verb = bare ? node.Scalar() : node.begin()->first.Scalar();
  if (std::find(kMissionVerbs.begin(), kMissionVerbs.end(), step.verb) == kMissionVerbs.end()) {
    document_.fail(path, anyOf(kMissionVerbs), inQuotes(step.verb));
  }
  if (bare) {
    return;
  }
  const YAML::Node arguments = node.begin()->second;
  const std::string below = path + "." + step.verb;
  if (arguments.IsScalar() && step.verb == "spell") {
    read(arguments, below, step.text, {});
  } else if (arguments.IsScalar() && step.verb == "wait") {
    read(arguments, below, step.seconds, durationOrAbsent());
  } else if (step.verb == "wait_until") {
    readEvent(arguments, below, step);
  } else {
    Reader reader(document_, arguments, below);
    describeArguments(reader, step);
    if (reader.known_.empty()) {
      document_.fail(path, "no more than the verb " + step.verb, found(arguments));
    }
    reader.finish();
  }
}

void Reader::readEvent(const YAML::Node& node, const std::string& path, MissionStep& step) {
  const auto seconds = numberIn<double>(node);
  const auto named = [&] {
    return std::find(kMissionEvents.begin(), kMissionEvents.end(), node.Scalar()) !=
           kMissionEvents.end();
  };
  if (seconds && *seconds >= 0.0 && std::isfinite(*seconds)) {
    step.seconds = *seconds;
  } else if (node.IsScalar() && named()) {
    step.text = node.Scalar();
  } else {
    document_.fail(path, "formed, go_on, or seconds since the take-off", found(node));
  }
}

void Reader::read(const YAML::Node& node, const std::string& path, std::vector<MissionStep>& steps,
                  const Constraint& constraint) {
  constexpr std::size_t kMostSteps = 1000;
  steps.clear();
  for (std::size_t i = 0; i < lengthOf(node, path); ++i) {
    const YAML::Node child = node[i];
    const std::string at = path + "[" + std::to_string(i) + "]";
    if (!child.IsMap() || child.size() != 1 || !child["repeat"]) {
      read(child, at, steps.emplace_back(), constraint);
      continue;
    }
    int times = 0;
    std::vector<MissionStep> repeated;
    Reader reader(document_, child["repeat"], at + ".repeat");
    reader("times", times, between(1.0, static_cast<double>(kMostSteps)));
    reader("steps", repeated);
    reader.finish();
    if (times == 0 || repeated.empty()) {
      document_.fail(at + ".repeat", "times and steps", "only one of them, or no steps");
    }
    if (steps.size() + static_cast<std::size_t>(times) * repeated.size() > kMostSteps) {
      document_.fail(at + ".repeat", "at most " + std::to_string(kMostSteps) + " steps", "more");
    }
    for (; times > 0; --times) {
      steps.insert(steps.end(), repeated.begin(), repeated.end());
    }
  }
}

std::size_t Reader::lengthOf(const YAML::Node& node, const std::string& path) const {
  if (!node.IsSequence()) {
    document_.fail(path, "a list", found(node));
  }
  return node.size();
}

}  // namespace roundabout::config
