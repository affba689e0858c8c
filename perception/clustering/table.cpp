#include "perception/clustering/table.h"

#include <array>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/core/error.h"
#include "perception/clustering/breakpoints/breakpoints.h"
#include "perception/clustering/dynamic_means/dynamic_means.h"

namespace roundabout::perception {

namespace {

constexpr std::array kClusterers = {
    ClustererEntry{"breakpoints", makeBreakpoints},
    ClustererEntry{"dynamic_means", makeDynamicMeans},
};

}  // namespace

std::span<const ClustererEntry> clustererTable() { return kClusterers; }

std::unique_ptr<Clusterer> makeClusterer(const std::string& name, const std::string& where) {
  std::vector<std::string_view> known;
  for (const ClustererEntry& entry : kClusterers) {
    if (entry.name == name) {
      return entry.make();
    }
    known.push_back(entry.name);
  }
  throw core::StartupError(where, "perception.clusterer",
                           fmt::format("one of {}", fmt::join(known, ", ")), "\"" + name + "\"");
}

}  // namespace roundabout::perception
