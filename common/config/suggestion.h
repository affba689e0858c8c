#pragma once

#include <string>
#include <vector>

namespace roundabout::config {

/// The known word that whoever wrote `typed` may have meant; empty if none is near.
std::string nearest(const std::string& typed, const std::vector<std::string>& known);

}  // namespace roundabout::config
