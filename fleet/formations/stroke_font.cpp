#include "fleet/formations/stroke_font.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::fleet {

namespace {

// In the font's units: capitals stand at y = 9 and are 21 high (y is down).
constexpr double kBaseline = 9.0;
constexpr double kCapitalHeight = 21.0;
constexpr char kFirstCharacter = ' ';
constexpr char kLastCharacter = '~';
constexpr std::size_t kCountColumn = 5;
constexpr std::size_t kCountWidth = 3;
constexpr std::size_t kPairsColumn = kCountColumn + kCountWidth;
constexpr std::string_view kPenUp = " R";

std::string installedFont() {
  const char* folder = std::getenv("HERSHEY_FONTS_DIR");
  return std::string(folder != nullptr ? folder : "/usr/share/hershey-fonts") + "/futural.jhf";
}

/// How many pairs the line says it has; 0 if it does not say.
std::size_t pairCount(std::string_view line) {
  if (line.size() < kPairsColumn) {
    return 0;
  }
  std::string_view digits = line.substr(kCountColumn, kCountWidth);
  digits.remove_prefix(std::min(digits.find_first_not_of(' '), digits.size()));
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  return error == std::errc() && end == digits.data() + digits.size() ? count : 0;
}

std::vector<Stroke> readStrokes(std::string_view vertices) {
  std::vector<Stroke> strokes;
  bool pen_down = false;
  for (; !vertices.empty(); vertices.remove_prefix(2)) {
    if (vertices.substr(0, 2) == kPenUp) {
      pen_down = false;
      continue;
    }
    if (!pen_down) {
      strokes.emplace_back();
      pen_down = true;
    }
    strokes.back().emplace_back((vertices[0] - 'R') / kCapitalHeight,
                                (kBaseline - (vertices[1] - 'R')) / kCapitalHeight);
  }
  return strokes;
}

}  // namespace

StrokeFont::StrokeFont() : StrokeFont(installedFont()) {}

StrokeFont::StrokeFont(const std::string& file) {
  std::ifstream in(file);
  if (!in) {
    throw core::StartupError(file, "letters", "the font of package hershey-fonts-data", "none");
  }
  std::string line;
  for (char character = kFirstCharacter; character <= kLastCharacter; ++character) {
    const std::string where = fmt::format("line {}", character - kFirstCharacter + 1);
    if (!std::getline(in, line)) {
      throw core::StartupError(file, where, fmt::format("the letter '{}'", character),
                               "the end of the file");
    }
    const std::size_t pairs = pairCount(line);
    if (pairs == 0 || line.size() != kPairsColumn + 2 * pairs) {
      throw core::StartupError(file, where, "a pair count in columns 6 to 8 and as many pairs",
                               fmt::format("\"{}\"", line));
    }
    std::vector<Stroke> strokes = readStrokes(std::string_view(line).substr(kPairsColumn + 2));
    if (!strokes.empty()) {
      glyphs_.emplace(character, std::move(strokes));
    }
  }
}

}  // namespace roundabout::fleet
