#pragma once

#include <cstdlib>
#include <filesystem>

namespace roundabout::test {

/// Facts and data of published work, which lie beside the project and are no part of it: the
/// folder in ROUNDABOUT_REFERENCE, else ../shared/reference. Tests that need it skip without it.
inline std::filesystem::path referenceFolder() {
  const char* folder = std::getenv("ROUNDABOUT_REFERENCE");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(ROUNDABOUT_SOURCE_DIR) / "../shared/reference";
}

}  // namespace roundabout::test
