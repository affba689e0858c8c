#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace roundabout::fleet {

/// A polyline, y up. A closed one ends where it begins.
using Stroke = std::vector<Eigen::Vector2d>;

/// The strokes of A. V. Hershey's plain sans-serif letters ("futural"), in units of the height of
/// its capitals; x from the centre line of the letter, y from the line it stands on.
class StrokeFont {
 public:
  /// Reads the font of Debian's package hershey-fonts-data (or of $HERSHEY_FONTS_DIR). Throws
  /// core::StartupError if it is not there.
  StrokeFont();
  /// Reads a file in James Hurt's format (.jhf): a line for each printable ASCII character from the
  /// blank on. Columns 1 to 5 hold a glyph number that nothing needs, 6 to 8 the number of pairs.
  /// Then come the pairs of characters, x and y (down) counted from 'R': first the left and the
  /// right edge, then vertices; " R" lifts the pen. Throws core::StartupError with the line if the
  /// file is not like that.
  explicit StrokeFont(const std::string& file);

  /// Printable and not blank. Everything else has no strokes.
  bool has(char character) const { return glyphs_.contains(character); }
  /// Precondition: has(character).
  const std::vector<Stroke>& strokes(char character) const { return glyphs_.at(character); }

 private:
  std::map<char, std::vector<Stroke>> glyphs_;
};

}  // namespace roundabout::fleet
