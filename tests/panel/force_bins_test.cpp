#include "tactus/panel/force_bins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

namespace tactus {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct BinnedForces {
  std::vector<double> t_s, force_N;
  std::vector<ForceBin> bins;
};

BinnedForces randomForces(std::mt19937& random, double width_s) {
  BinnedForces binned;
  ForceBins bins(width_s);
  std::normal_distribution<double> force;
  const int cycles = 1 + static_cast<int>(random() % 500);
  for (int i = 0; i < cycles; ++i) {
    binned.t_s.push_back(0.001 * i);
    binned.force_N.push_back(force(random));
    bins.add(binned.t_s.back(), {&binned.force_N.back(), 1});
  }
  bins.add(1e9, {&binned.force_N.back(), 1});  // completes the last one
  binned.bins = bins.complete();
  return binned;
}

TEST(ForceBinsTest, HoldEachCycleOnceInOrder) {
  std::mt19937 random(1);
  for (int run = 0; run < 300; ++run) {
    const double width_s = 0.001 * static_cast<double>(1 + random() % 20);
    const BinnedForces binned = randomForces(random, width_s);
    std::size_t i = 0;
    for (const ForceBin& bin : binned.bins) {
      double least_N = std::numeric_limits<double>::infinity(), most_N = -least_N;
      ASSERT_EQ(bin.from_s, binned.t_s[i]);
      for (; i < binned.t_s.size() && binned.t_s[i] <= bin.to_s; ++i) {
        least_N = std::min(least_N, binned.force_N[i]);
        most_N = std::max(most_N, binned.force_N[i]);
      }
      ASSERT_EQ(bin.least_N[0], least_N);
      ASSERT_EQ(bin.most_N[0], most_N);
      ASSERT_LT(bin.to_s - bin.from_s, width_s);
    }
    ASSERT_EQ(i, binned.t_s.size());
  }
}

TEST(ForceBinsTest, LosePeaksNeverHoweverFewTheyAre) {
  std::mt19937 random(2);
  for (int run = 0; run < 300; ++run) {
    const BinnedForces binned = randomForces(random, 0.004);
    const std::size_t most = 1 + random() % 40;
    const std::vector<ForceBin> fewer = fewerBins(binned.bins, most);
    ASSERT_LE(fewer.size(), most);
    ASSERT_GE(2 * fewer.size(), std::min(most, binned.bins.size()));
    const auto [least, largest] = std::ranges::minmax(binned.force_N);
    ASSERT_EQ(
        std::ranges::min(fewer, {}, [](const ForceBin& bin) { return bin.least_N[0]; }).least_N[0],
        least);
    ASSERT_EQ(
        std::ranges::max(fewer, {}, [](const ForceBin& bin) { return bin.most_N[0]; }).most_N[0],
        largest);
    ASSERT_EQ(fewer.front().from_s, binned.bins.front().from_s);
    ASSERT_EQ(fewer.back().to_s, binned.bins.back().to_s);
    for (std::size_t i = 1; i < fewer.size(); ++i) ASSERT_GT(fewer[i].from_s, fewer[i - 1].to_s);
  }
}

TEST(ForceBinsTest, KeepModulesApartAndLeaveOutWhatIsNoForce) {
  ForceBins bins(0.01);
  bins.add(0.0, std::vector<double>{1.0, kNaN, 5.0});
  bins.add(0.001, std::vector<double>{3.0, kNaN, kNaN});
  bins.add(0.02, std::vector<double>{9.0, 9.0, 9.0});
  ASSERT_EQ(bins.complete().size(), 1u);
  EXPECT_EQ(forceJson(bins.complete(), 0, 3).dump(),
            R"({"t":[0.0],"low":[[1.0],[null],[5.0]],"high":[[3.0],[null],[5.0]]})");
  EXPECT_EQ(forceJson(bins.complete(), 2, 1, 0.5).dump(),
            R"({"t":[-0.5],"low":[[5.0]],"high":[[5.0]]})");
  EXPECT_EQ(forceJson({}, 0, 1).dump(), R"({"t":[],"low":[[]],"high":[[]]})");
}

TEST(ForceBinsTest, BeginAnewWhereTheClockGoesBack) {
  ForceBins bins(10.0);
  for (const double t_s : {5.0, 6.0, 1.0, 2.0}) bins.add(t_s, std::vector<double>{t_s});
  ASSERT_EQ(bins.complete().size(), 1u);
  EXPECT_EQ(bins.complete()[0].most_N[0], 6.0);
}

}  // namespace
}  // namespace tactus
