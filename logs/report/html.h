#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace roundabout::logs {

/// Text with nothing left that HTML interprets.
std::string escaped(std::string_view text);

std::string base64(std::string_view bytes);

/// Cells are HTML already; the first column is text, the others are numbers.
std::string htmlTable(const std::vector<std::string>& header,
                      const std::vector<std::vector<std::string>>& rows);

}  // namespace roundabout::logs
