#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "learning/evaluation/test_case.h"

namespace roundabout::learning {

/// Test cases that belong to one figure or table.
struct Suite {
  std::string name;
  std::vector<CaseGroup> groups;
  std::optional<double> goal_distance_m;  ///< in place of the rules'
};

struct SuiteEntry {
  std::string_view name;
  std::string_view description;
  Suite (*make)();
};

/// Every suite there is. The same cases every time.
std::span<const SuiteEntry> suiteTable();

/// Throws core::StartupError for an unknown name.
Suite makeSuite(const std::string& name);

}  // namespace roundabout::learning
