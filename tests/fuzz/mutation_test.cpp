// A short, repeatable run of what tests/fuzz/fuzz_main.cpp does for hours. It needs no clang.

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "mocap_bridge/sources/table.h"
#include "tests/fuzz/targets.h"

namespace roundabout::test {
namespace {

// Numbers at which counts and sizes go wrong.
constexpr std::uint32_t kCruel[] = {0,      1,          0x7f,       0x80,      0xff,
                                    0xffff, 0x7fffffff, 0x80000000, 0xffffffff};

Input mutated(Input input, core::RandomStream& random) {
  const std::size_t changes = 1 + random.index(4);
  for (std::size_t i = 0; i < changes && !input.empty(); ++i) {
    const std::size_t at = random.index(input.size());
    switch (random.index(5)) {
      case 0:
        input[at] = std::byte(random.index(256));
        break;
      case 1:
        input.resize(at);
        break;
      case 2:
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), random.index(64), input[at]);
        break;
      case 3:
        input.erase(input.begin() + static_cast<std::ptrdiff_t>(at),
                    input.begin() +
                        static_cast<std::ptrdiff_t>(std::min(input.size(), at + random.index(64))));
        break;
      default: {
        std::uint32_t number = kCruel[random.index(std::size(kCruel))];
        for (std::size_t k = at; k < std::min(input.size(), at + 4); ++k, number >>= 8) {
          input[k] = std::byte(number & 0xff);
        }
      }
    }
  }
  return input;
}

class Hostile : public testing::TestWithParam<FuzzTarget> {};

TEST_P(Hostile, MutatedSeedsDoNoHarm) {
  constexpr int kInputs = 20'000;
  const std::vector<Input> seeds = GetParam().seeds();
  ASSERT_FALSE(seeds.empty());
  core::RandomStream random(1, GetParam().name);
  for (int i = 0; i < kInputs; ++i) {
    GetParam().run(mutated(seeds[random.index(seeds.size())], random));
  }
}

TEST_P(Hostile, ASeedIsUnderstood) {
  std::size_t most = 0;
  for (const Input& seed : GetParam().seeds()) {
    most = std::max(most, GetParam().run(seed));
  }
  const bool file = std::string(GetParam().name) == "packet_file";
  EXPECT_GE(most, file ? 1U : 4U) << "packets have to meet what those before them left";
}

TEST_P(Hostile, SeedsCutAtEveryByteDoNoHarm) {
  for (const Input& seed : GetParam().seeds()) {
    const std::size_t most = std::min<std::size_t>(seed.size(), 600);
    for (std::size_t size = 0; size <= most; ++size) {
      GetParam().run(mocap_bridge::Bytes(seed).first(size));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Parsers, Hostile,
                         testing::ValuesIn(fuzzTargets().begin(), fuzzTargets().end()),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(FuzzTargets, EveryProtocolIsAmongThem) {
  for (const mocap_bridge::Protocol& protocol : mocap_bridge::protocols()) {
    EXPECT_NO_THROW(fuzzTargetNamed(std::string(protocol.name)));
  }
}

}  // namespace
}  // namespace roundabout::test
