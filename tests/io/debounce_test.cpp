#include "tactus/io/debounce.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

TEST(Debounce, WithoutDurationsFollowsTheLevel) {
  std::mt19937 random(1);
  for (const int cycles : {0, 1}) {
    Debounce contact(cycles, cycles, false);
    for (int i = 0; i < 100; ++i) {
      const bool level = random() % 2 == 0;
      EXPECT_EQ(contact.update(level), level);
    }
  }
}

TEST(Debounce, AnEmergencyStopActsAtOnceAndIsReleasedOnlyForGood) {
  Debounce stop(0, 5, false);
  EXPECT_TRUE(stop.update(true));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(stop.update(false));
  EXPECT_TRUE(stop.update(true)) << "bounces: the count begins anew";
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(stop.update(false));
  EXPECT_FALSE(stop.update(false));
}

TEST(Debounce, AContactMayHaveToLastBothWays) {
  Debounce enable(3, 3, false);
  EXPECT_FALSE(enable.update(true));
  EXPECT_FALSE(enable.update(true));
  EXPECT_TRUE(enable.update(true));
  EXPECT_TRUE(enable.update(false));
  EXPECT_TRUE(enable.update(false));
  EXPECT_FALSE(enable.update(false));
}

/// Against the definition: active is what the last so many readings agree on, else what it was.
TEST(Debounce, AgreesWithItsDefinitionOnRandomLevels) {
  std::mt19937 random(2);
  for (int run = 0; run < 200; ++run) {
    const int activation = static_cast<int>(random() % 6);
    const int release = static_cast<int>(random() % 6);
    bool expected = random() % 2 == 0;
    Debounce contact(activation, release, expected);
    std::vector<bool> levels;
    for (int i = 0; i < 300; ++i) {
      levels.push_back(random() % 4 != 0);
      const int needed = std::max(1, expected ? release : activation);
      const bool lasted =
          static_cast<int>(levels.size()) >= needed &&
          std::all_of(levels.end() - needed, levels.end(), [&](bool l) { return l != expected; });
      if (lasted) expected = !expected;
      ASSERT_EQ(contact.update(levels.back()), expected) << run << " " << i;
    }
  }
}

TEST(Debounce, CountsCyclesThatCoverADuration) {
  EXPECT_EQ(cyclesCovering(0.0, 0.001), 0);
  EXPECT_EQ(cyclesCovering(0.003, 0.001), 3);
  EXPECT_EQ(cyclesCovering(0.0031, 0.001), 4);
  EXPECT_EQ(cyclesCovering(0.0001, 0.001), 1);
  EXPECT_EQ(cyclesCovering(0.07, 0.01), 7);
  EXPECT_GT(cyclesCovering(1e300, 0.001), 1000000);
}

}  // namespace
}  // namespace tactus
