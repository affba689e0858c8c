#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace roundabout::fleet {

/// A polyline, y up. A closed one ends where it begins.
using Stroke = std::vector<Eigen::Vector2d>;

/// The strokes of A. V. Hershey's plain sans-serif letters ("futural"), in units of the height of
/// its capitals.
class StrokeFont {
 public:
  /// Reads the font of Debian's package hershey-fonts-data (or of $HERSHEY_FONTS_DIR). Throws
  /// core::StartupError if it is not there.
  StrokeFont();
  explicit StrokeFont(const std::string& file);

  /// Printable and not blank. Everything else has no strokes.
  bool has(char character) const { return glyphs_.contains(character); }
  /// Precondition: has(character).
  const std::vector<Stroke>& strokes(char character) const { return glyphs_.at(character); }

 private:
  std::map<char, std::vector<Stroke>> glyphs_;
};

}  // namespace roundabout::fleet
