// One libFuzzer program a target: ROUNDABOUT_FUZZ_TARGET names it.

#include <cstdint>
#include <span>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const roundabout::test::FuzzTarget& target =
      roundabout::test::fuzzTargetNamed(ROUNDABOUT_FUZZ_TARGET);
  target.run(std::as_bytes(std::span(data, size)));
  return 0;
}
