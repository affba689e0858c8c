// docs/experiment_file.md names every key with its default.

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/common/config/key_collector.h"

namespace roundabout::config {
namespace {

// Keys that are read into others and are not written back.
const std::set<std::string> kInputOnly{"vehicle_defaults", "mission[].formation.points_file"};

std::string trimmed(std::string text) {
  text.erase(0, text.find_first_not_of(" `"));
  text.erase(text.find_last_not_of(" `") + 1);
  return text;
}

/// Rows of the page's tables whose first cell is a key in backquotes: key, and the second cell.
std::map<std::string, std::string> documentedKeys() {
  std::ifstream page(ROUNDABOUT_SOURCE_DIR "/docs/experiment_file.md");
  std::map<std::string, std::string> keys;
  std::string line;
  while (std::getline(page, line)) {
    if (line.starts_with("| `")) {
      std::istringstream cells(line.substr(1));
      std::string key;
      std::string second;
      std::getline(cells, key, '|');
      std::getline(cells, second, '|');
      keys[trimmed(key)] = trimmed(second);
    }
  }
  return keys;
}

std::map<std::string, std::string> knownKeys() {
  Experiment experiment;
  KeyCollector collector;
  describe(collector, experiment);
  return collector.keys();
}

TEST(ExperimentFilePage, NamesEveryKeyWithItsDefault) {
  const std::map<std::string, std::string> documented = documentedKeys();
  for (const auto& [key, value] : knownKeys()) {
    ASSERT_TRUE(documented.contains(key)) << key;
    if (!value.empty()) {
      EXPECT_EQ(documented.at(key), value) << key;
    }
  }
}

TEST(ExperimentFilePage, NamesNoKeyThatDoesNotExist) {
  const std::map<std::string, std::string> known = knownKeys();
  for (const auto& [key, value] : documentedKeys()) {
    EXPECT_TRUE(known.contains(key) || kInputOnly.contains(key)) << key;
  }
}

}  // namespace
}  // namespace roundabout::config
