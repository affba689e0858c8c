#pragma once

#include <iosfwd>
#include <string>

namespace roundabout::planner {

/// Writes what a weight file holds: metadata, tensors with their shapes, number of parameters.
/// Throws core::StartupError if the file is damaged, or, after writing, if no policy accepts it.
void printWeightsInfo(const std::string& path, std::ostream& out);

}  // namespace roundabout::planner
