#pragma once

// What is fuzzed, with and without libFuzzer: every parser and interpreter of bytes that come off a
// network or out of a file.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mocap_bridge/sources/byte_cursor.h"

namespace roundabout::test {

using Input = std::vector<std::byte>;

struct FuzzTarget {
  const char* name;
  /// Must neither crash nor throw nor allocate more than the input's size allows. Returns how many
  /// frames, or packets of a file, were understood.
  std::size_t (*run)(mocap_bridge::Bytes input);
  /// Valid inputs to begin with: made by our own writers, and the captured packets where they are.
  std::vector<Input> (*seeds)();
};

std::span<const FuzzTarget> fuzzTargets();
/// Throws std::runtime_error if there is none.
const FuzzTarget& fuzzTargetNamed(const std::string& name);

}  // namespace roundabout::test
