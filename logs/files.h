#pragma once

#include <string>
#include <string_view>

namespace roundabout::logs {

/// Replaces the file. Throws core::StartupError if it cannot be written.
void writeFile(const std::string& file, std::string_view content);

/// The file's bytes. Throws core::StartupError if it cannot be read.
std::string readFile(const std::string& file);

/// Makes the folder and its parents. Throws core::StartupError if that fails.
void makeFolder(const std::string& folder);

}  // namespace roundabout::logs
