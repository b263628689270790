#include "tactus/bench/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tactus {
namespace {

TEST(InParallel, DoesAllOfItOnce) {
  std::vector<std::atomic<int>> done(1000);
  inParallel(done.size(), [&](std::size_t i) { ++done[i]; });
  for (const std::atomic<int>& one : done) EXPECT_EQ(one, 1);
}

/// Whichever worker it is of.
TEST(InParallel, ThrowsOnWhatWorkThrows) {
  std::atomic<int> done = 0;
  const auto work = [&](std::size_t i) {
    if (i % 10 == 9) throw std::runtime_error("lost");
    ++done;
  };
  EXPECT_THROW(inParallel(1'000'000, work), std::runtime_error);
  EXPECT_LT(done, 1'000'000 / 2);
}

}  // namespace
}  // namespace tactus
