#pragma once

#include <map>
#include <string>

namespace roundabout::planner {

/// All keys and values of a table file in LevelDB's format. Throws core::StartupError if the file
/// is missing, truncated, or a block is not as its sum says.
std::map<std::string, std::string> readTable(const std::string& path);

}  // namespace roundabout::planner
