#include "tactus/math/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace tactus {
namespace {

constexpr std::size_t kPerMyriads[] = {0, 10, 100, 700, 2500, 5000, 5500, 9000, 9900, 9990, 10000};

std::int64_t exactPercentile(const std::vector<std::int64_t>& sorted, std::size_t per_myriad) {
  const std::size_t rank = (per_myriad * sorted.size() + 9999) / 10000;
  return sorted[std::max<std::size_t>(1, rank) - 1];
}

void expectCloseToSorting(std::vector<std::int64_t> values) {
  Histogram histogram;
  for (const std::int64_t value : values) histogram.add(value);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(histogram.count(), values.size());
  EXPECT_EQ(histogram.min_ns(), values.front());
  EXPECT_EQ(histogram.max_ns(), values.back());
  for (const std::size_t per_myriad : kPerMyriads) {
    const std::int64_t exact = exactPercentile(values, per_myriad);
    const double percent = static_cast<double>(per_myriad) / 100.0;
    EXPECT_GE(histogram.percentile_ns(percent), exact) << percent;
    EXPECT_LE(histogram.percentile_ns(percent) - exact, exact / 16) << percent;
  }
  EXPECT_EQ(histogram.percentile_ns(100.0), values.back());
}

TEST(Histogram, agreesWithSortingUpToASixteenth) {
  std::mt19937_64 random(7);
  for (int run = 0; run < 100; ++run) {
    std::vector<std::int64_t> values(1 + random() % 3000);
    const int most_bits = static_cast<int>(1 + random() % 62);
    for (std::int64_t& value : values) {
      value = static_cast<std::int64_t>(random() >> (64 - 1 - random() % most_bits));
    }
    expectCloseToSorting(values);
    ASSERT_FALSE(HasFailure()) << "run " << run;
  }
}

/// 0.999 times 1000 is a little above 999 in doubles.
TEST(Histogram, takesNoRankTooManyWhereItIsWhole) {
  for (int thousands = 1; thousands <= 300; ++thousands) {
    Histogram histogram;
    for (int i = 0; i < 1000 * thousands; ++i) histogram.add(i < 999 * thousands ? 1 : 1'000'000);
    EXPECT_EQ(histogram.percentile_ns(99.9), 1) << thousands;
  }
}

TEST(Histogram, agreesWithSortingAroundEachPowerOfTwo) {
  for (int bits = 0; bits < 63; ++bits) {
    const std::int64_t power = std::int64_t{1} << bits;
    for (const std::int64_t value : {power - 1, power, power + power / 16, power + (power - 1)}) {
      expectCloseToSorting({value});
      expectCloseToSorting({value, value, INT64_MAX});
      ASSERT_FALSE(HasFailure()) << value;
    }
  }
}

TEST(Histogram, isExactBelow32) {
  Histogram histogram;
  for (std::int64_t value = 0; value < 32; ++value) histogram.add(value);
  histogram.add(1'000'000);
  for (int value = 0; value < 32; ++value) {
    EXPECT_EQ(histogram.percentile_ns(100.0 * (value + 1) / 33.0 - 0.1), value);
  }
}

TEST(Histogram, takesNegativeValuesAsZero) {
  Histogram histogram;
  histogram.add(INT64_MIN);
  histogram.add(-1);
  EXPECT_EQ(histogram.count(), 2u);
  EXPECT_EQ(histogram.min_ns(), 0);
  EXPECT_EQ(histogram.max_ns(), 0);
  EXPECT_EQ(histogram.percentile_ns(100.0), 0);
}

TEST(Histogram, readsAsZeroWhileEmpty) {
  const Histogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.min_ns(), 0);
  EXPECT_EQ(histogram.max_ns(), 0);
  EXPECT_EQ(histogram.percentile_ns(50.0), 0);
}

TEST(Histogram, takesPercentsOutOfRangeAsTheNearest) {
  Histogram histogram;
  histogram.add(5);
  histogram.add(9);
  EXPECT_EQ(histogram.percentile_ns(-10.0), 5);
  EXPECT_EQ(histogram.percentile_ns(1000.0), 9);
}

TEST(Histogram, bucketsHoldEveryValueOnceInOrder) {
  Histogram histogram;
  histogram.forEachBucket([](std::int64_t, std::uint64_t) { FAIL() << "empty"; });
  for (const std::int64_t value : {5, 5, 31, 1'000, 1'001, 1'000'000}) histogram.add(value);
  std::int64_t before_ns = -1;
  std::uint64_t count = 0;
  std::vector<std::int64_t> highest;
  histogram.forEachBucket([&](std::int64_t highest_ns, std::uint64_t in_it) {
    EXPECT_GT(highest_ns, before_ns);
    EXPECT_GT(in_it, 0u);
    before_ns = highest_ns;
    count += in_it;
    highest.push_back(highest_ns);
  });
  EXPECT_EQ(count, histogram.count());
  ASSERT_EQ(highest.size(), 4u);
  EXPECT_EQ(highest[0], 5);
  EXPECT_EQ(highest[1], 31);
  EXPECT_GE(highest[2], 1'001);
}

}  // namespace
}  // namespace tactus
