#pragma once

#include <span>

namespace roundabout::logs {

struct OwnType {
  const char* file;
  const char* text;
};

/// The files of lcmtypes/, made part of the program by cmake/EmbedTypes.cmake.
extern const std::span<const OwnType> kOwnTypes;

}  // namespace roundabout::logs
