#include "tactus/rt/newest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace tactus {
namespace {

TEST(NewestValue, IsTakenOnce) {
  NewestValue<int> newest;
  int value = 7;
  EXPECT_FALSE(newest.take(value));
  EXPECT_EQ(value, 7);
  newest.put(1);
  newest.put(2);
  EXPECT_TRUE(newest.take(value));
  EXPECT_EQ(value, 2);
  EXPECT_FALSE(newest.take(value));
  newest.put(3);
  EXPECT_TRUE(newest.take(value));
  EXPECT_EQ(value, 3);
}

/// Never half of one value and half of another, never an older one after a newer one, and the last
/// one is not lost.
TEST(NewestValue, IsWholeAndGetsNewer) {
  using Value = std::array<std::uint64_t, 40>;
  constexpr std::uint64_t kLast = 200'000;
  NewestValue<Value> newest;
  std::thread producer([&] {
    Value value;
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      value.fill(i);
      newest.put(value);
    }
  });
  std::uint64_t before = 0;
  Value value;
  while (before != kLast) {
    if (!newest.take(value)) continue;
    for (const std::uint64_t word : value) ASSERT_EQ(word, value[0]);
    ASSERT_GT(value[0], before);
    before = value[0];
  }
  producer.join();
}

}  // namespace
}  // namespace tactus
