#pragma once

#include <cstddef>

namespace roundabout::test {

/// How often operator new or malloc was called so far in this process. For a program that links it,
/// in which it replaces the global operators and wraps malloc.
std::size_t allocationCount();

}  // namespace roundabout::test
