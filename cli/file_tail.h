#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace roundabout::cli {

/// The last bytes of a file, all of it if it is smaller; empty if it cannot be read.
std::string fileTail(const std::filesystem::path& file, std::size_t bytes);

}  // namespace roundabout::cli
