#pragma once

#include <string>
#include <vector>

namespace roundabout::config {

/// The text with a space for every control character, cut where it gets long.
std::string oneLine(const std::string& text);

/// oneLine in double quotes.
std::string inQuotes(const std::string& text);

/// The known word that whoever wrote `typed` may have meant; empty if none is near.
std::string nearest(const std::string& typed, const std::vector<std::string>& known);

}  // namespace roundabout::config
