#include "tactus/canopen/rest_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace tactus {
namespace {

TEST(RestWatch, LeavesAnAxisThatSlowsDownToItself) {
  for (const double deceleration : {0.2, 1.0, 20.0}) {  // rad/s^2, from 2 rad/s, or from less
    RestWatch watch(0.001);
    double speed = std::min(2.0, 0.45 * deceleration);
    double q = 0.0;
    for (int i = 0; i < 490; ++i) {
      EXPECT_FALSE(watch.update(q, 1)) << deceleration << " " << i;
      q += 0.001 * speed;
      speed = std::max(0.0, speed - 0.001 * deceleration);
    }
  }
}

/// Feedback that now comes before the cycle reads and now after it is of another time, not faster.
TEST(RestWatch, SeesAnAxisThatMovesOnAlsoWhereItsFeedbackJitters) {
  std::mt19937 random(7);
  for (int run = 0; run < 100; ++run) {
    RestWatch watch(0.001);
    int sent = 0, heard = 0, cycles = 0;
    bool moves_on = false;
    for (; !moves_on && cycles < 200; ++cycles) {
      ++sent;
      const int late = random() % 3 == 0 ? 1 : 0;
      const int periods = std::max(0, sent - late - heard);
      heard += periods;
      moves_on = watch.update(1e-3 * heard, periods);  // 1 rad/s
    }
    EXPECT_GE(cycles, 100);
    EXPECT_LE(cycles, 104);
  }
}

/// Its windows are 64 periods, so that the ways in them are as they are written here, to the bit.
bool movesOn(const std::vector<double>& positions) {
  RestWatch watch(RestWatch::kWindow_s / 64);
  bool moves_on = watch.update(positions.front(), 1);
  for (std::size_t i = 1; i < positions.size(); ++i) moves_on = watch.update(positions[i], 64);
  return moves_on;
}

TEST(RestWatch, MovingOnIsFurtherThanItsLimitsSay) {
  EXPECT_FALSE(movesOn({0.0, RestWatch::kMoved, 0.0}));
  EXPECT_TRUE(movesOn({0.0, 1.001 * RestWatch::kMoved, 0.0}));
  EXPECT_FALSE(movesOn({0.0, 0.25, RestWatch::kSlowing})) << "shorter by just as much";
  EXPECT_TRUE(movesOn({0.0, 0.25, 0.999 * RestWatch::kSlowing}));
  EXPECT_FALSE(movesOn({0.0, 0.25})) << "in one window";
}

}  // namespace
}  // namespace tactus
