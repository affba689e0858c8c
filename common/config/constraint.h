#pragma once

#include <limits>
#include <string>
#include <vector>

namespace roundabout::config {

/// What a key's value must fulfil beyond its type. One struct for every type; each type looks at
/// what concerns it.
struct Constraint {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_excluded = false;
  std::vector<std::string> choices;  ///< for text; empty: any
  bool identifier = false;           ///< for text: letters, digits and underscore, at least one
  bool height_optional = false;      ///< for points: [x, y] is read with a z that is NaN
  bool negative_is_absent = false;   ///< for numbers: a negative one is not written
  bool input_only = false;           ///< read, never written

  /// "a number above 0", where `kind` is "a number" or "a whole number".
  std::string expectedNumber(const std::string& kind) const;
  bool admits(double number) const;

  /// "lockstep or real_time"; "text" if any will do.
  std::string expectedText() const;
  bool admits(const std::string& text) const;
};

Constraint above(double low);
Constraint atLeast(double low);
Constraint between(double low, double high);
Constraint oneOf(std::vector<std::string> choices);
Constraint identifier();
Constraint heightOptional();
Constraint durationOrAbsent();
Constraint inputOnly();

/// Letters, digits and underscore, at least one: what an LCM channel name can end in.
bool isIdentifier(const std::string& text);

}  // namespace roundabout::config
