#include "common/core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace roundabout::core {
namespace {

TEST(RandomStream, GivesTheSameNumbersForever) {
  RandomStream random(1, "golden");
  EXPECT_DOUBLE_EQ(random.uniform(0.0, 1.0), 0.063926973125979836);
  EXPECT_DOUBLE_EQ(random.uniform(-1.0, 3.0), -0.36065599143368132);
  EXPECT_DOUBLE_EQ(random.normal(2.0), -1.1847345493315686);
  EXPECT_EQ(random.index(1000), 121u);
}

TEST(RandomStream, DiffersByNameAndBySeed) {
  RandomStream one(1, "mocap");
  RandomStream other_name(1, "assignment");
  RandomStream other_seed(2, "mocap");
  RandomStream high_seed(1 + (std::uint64_t{1} << 32), "mocap");
  const double value = one.uniform(0.0, 1.0);
  EXPECT_NE(value, other_name.uniform(0.0, 1.0));
  EXPECT_NE(value, other_seed.uniform(0.0, 1.0));
  EXPECT_NE(value, high_seed.uniform(0.0, 1.0));
}

TEST(RandomStream, StreamsOfOneSeedAreNotCorrelated) {
  RandomStream a(7, "a");
  RandomStream b(7, "b");
  constexpr int kDraws = 100000;
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    sum += a.uniform(-1.0, 1.0) * b.uniform(-1.0, 1.0);
  }
  // The product has standard deviation 1/3; five of the mean's.
  EXPECT_LT(std::abs(sum / kDraws), 5.0 / 3.0 / std::sqrt(kDraws));
}

TEST(RandomStream, UniformFillsItsRangeEvenly) {
  RandomStream random(3, "uniform");
  std::array<int, 20> histogram{};
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform(-2.0, 2.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 2.0);
    ++histogram[static_cast<std::size_t>((value + 2.0) * 5.0)];
  }
  for (const int count : histogram) {
    EXPECT_NEAR(count, kDraws / 20, 5.0 * std::sqrt(kDraws / 20.0));
  }
}

TEST(RandomStream, NormalHasItsDeviation) {
  RandomStream random(3, "normal");
  constexpr int kDraws = 200000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal(0.5);
    ASSERT_TRUE(std::isfinite(value));
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / kDraws), 0.5, 0.01);
}

TEST(RandomStream, ANormalTakesTheSameNumberOfDrawsAlways) {
  RandomStream random(3, "draws");
  RandomStream skipped(3, "draws");
  random.normal(1.0);
  skipped.uniform(0.0, 1.0);
  skipped.uniform(0.0, 1.0);
  EXPECT_EQ(random.uniform(0.0, 1.0), skipped.uniform(0.0, 1.0));
}

TEST(RandomStream, ChanceOfZeroNeverAndOfOneAlwaysHappens) {
  RandomStream random(3, "chance");
  for (int i = 0; i < 1000; ++i) {
    ASSERT_FALSE(random.chance(0.0));
    ASSERT_TRUE(random.chance(1.0));
  }
}

TEST(RandomStream, ShuffleGivesEveryPermutationAlikeOften) {
  RandomStream random(3, "shuffle");
  std::array<int, 6> histogram{};
  constexpr int kDraws = 60000;
  for (int i = 0; i < kDraws; ++i) {
    std::vector<int> items = {0, 1, 2};
    random.shuffle(items);
    const int rank = 2 * items[0] + (items[1] > items[2] ? 1 : 0);
    ++histogram[static_cast<std::size_t>(rank)];
  }
  for (const int count : histogram) {
    EXPECT_NEAR(count, kDraws / 6, 5.0 * std::sqrt(kDraws / 6.0));
  }
}

TEST(RandomStream, ShuffleOfNothingOrOneItemIsFine) {
  RandomStream random(3, "shuffle");
  std::vector<int> none;
  std::vector<int> one = {5};
  random.shuffle(none);
  random.shuffle(one);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(one, std::vector<int>{5});
}

}  // namespace
}  // namespace roundabout::core
