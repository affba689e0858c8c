#include "common/config/words.h"

#include <algorithm>
#include <cstddef>

namespace roundabout::config {

namespace {

// Insertions, deletions and replacements that turn `typed` into `known`; with `within`, into the
// part of `known` that is nearest to it.
std::size_t editDistance(const std::string& typed, const std::string& known, bool within) {
  std::vector<std::size_t> row;
  for (std::size_t j = 0; j <= known.size(); ++j) {
    row.push_back(within ? 0 : j);
  }
  for (std::size_t i = 1; i <= typed.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j < row.size(); ++j) {
      const std::size_t replaced = diagonal + (typed[i - 1] == known[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return within ? *std::min_element(row.begin(), row.end()) : row.back();
}

}  // namespace

std::string oneLine(const std::string& text) {
  constexpr std::size_t kLongest = 80;
  std::string line = text.substr(0, kLongest);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text.size() > kLongest ? line + "..." : line;
}

std::string inQuotes(const std::string& text) { return '"' + oneLine(text) + '"'; }

std::string nearest(const std::string& typed, const std::vector<std::string>& known) {
  const auto best = [&](bool within, std::size_t limit) -> std::string {
    std::size_t best_distance = limit + 1;
    std::string best_word;
    for (const std::string& word : known) {
      const std::size_t distance = editDistance(typed, word, within);
      if (distance < best_distance) {
        best_distance = distance;
        best_word = word;
      }
    }
    return best_word;
  };
  std::string whole = best(false, 1 + typed.size() / 4);
  // "radus_m" is far from "assumed_radius_m" but near to its end.
  return !whole.empty() || typed.size() < 4 ? whole : best(true, typed.size() / 5);
}

}  // namespace roundabout::config
