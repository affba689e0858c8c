#pragma once

#include <string>

#include "common/core/error.h"

namespace roundabout::test {

/// The line that the user sees when `start` fails; empty if it does not.
template <class Start>
std::string startupErrorOf(const Start& start) {
  try {
    start();
  } catch (const core::StartupError& error) {
    return error.what();
  }
  return {};
}

}  // namespace roundabout::test
