#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "perception/clustering/clusterer.h"

namespace roundabout::perception {

struct ClustererEntry {
  std::string_view name;
  std::unique_ptr<Clusterer> (*make)();
};

/// Every clusterer there is; a new one is a sub-folder and a line in table.cpp.
std::span<const ClustererEntry> clustererTable();

/// Throws core::StartupError with `where` (the experiment file) if there is none of this name.
std::unique_ptr<Clusterer> makeClusterer(const std::string& name, const std::string& where);

}  // namespace roundabout::perception
