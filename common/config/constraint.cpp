#include "common/config/constraint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace roundabout::config {

std::string Constraint::expectedNumber(const std::string& kind) const {
  if (std::isfinite(low) && std::isfinite(high)) {
    return fmt::format("{} from {} to {}", kind, low, high);
  }
  if (std::isfinite(low)) {
    return fmt::format("{} {} {}", kind, low_excluded ? "above" : "of at least", low);
  }
  return kind;
}

bool Constraint::admits(double number) const {
  return std::isfinite(number) && (low_excluded ? number > low : number >= low) && number <= high;
}

std::string Constraint::expectedText() const {
  if (identifier) {
    return "letters, digits and underscore";
  }
  return choices.empty() ? "text" : fmt::format("{}", fmt::join(choices, " or "));
}

bool Constraint::admits(const std::string& text) const {
  if (identifier) {
    return isIdentifier(text);
  }
  return choices.empty() || std::find(choices.begin(), choices.end(), text) != choices.end();
}

Constraint above(double low) {
  Constraint constraint;
  constraint.low = low;
  constraint.low_excluded = true;
  return constraint;
}

Constraint atLeast(double low) {
  Constraint constraint;
  constraint.low = low;
  return constraint;
}

Constraint between(double low, double high) {
  Constraint constraint;
  constraint.low = low;
  constraint.high = high;
  return constraint;
}

Constraint oneOf(std::vector<std::string> choices) {
  Constraint constraint;
  constraint.choices = std::move(choices);
  return constraint;
}

Constraint identifier() {
  Constraint constraint;
  constraint.identifier = true;
  return constraint;
}

Constraint heightOptional() {
  Constraint constraint;
  constraint.height_optional = true;
  return constraint;
}

Constraint durationOrAbsent() {
  Constraint constraint = atLeast(0.0);
  constraint.negative_is_absent = true;
  return constraint;
}

Constraint inputOnly() {
  Constraint constraint;
  constraint.input_only = true;
  return constraint;
}

bool isIdentifier(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace roundabout::config
