#include "tactus/canopen/joint_tracking.h"

#include <gtest/gtest.h>

#include <utility>

namespace tactus {
namespace {

JointVector both(double first, double second) { return Eigen::Vector2d(first, second); }

TEST(CommandedPlaces, AreOneWhereNoCycleWasMissed) {
  CommandedPlaces places(both(1.0, 2.0));
  places.command(both(1.5, 2.5));
  EXPECT_EQ(places.at(0).now, 1.5);
  EXPECT_EQ(places.at(0).before_pause, 1.5);
  places.expect(both(1.6, 2.6));
  EXPECT_EQ(places.at(1).now, 2.6);
  EXPECT_EQ(places.at(1).before_pause, 2.6);
}

/// Of the cycle after them feedback comes in the next one, and may be late by one more.
TEST(CommandedPlaces, KeepThatOfBeforeMissedCyclesAsLongAsFeedbackMayBeOfThen) {
  CommandedPlaces places(both(0.0, 0.0));
  places.command(both(1.0, 2.0));
  places.coast();
  places.expect(both(5.0, 6.0));
  for (int cycle = 0; cycle < 3; ++cycle) {
    EXPECT_EQ(places.at(0).now, 5.0 + cycle);
    EXPECT_EQ(places.at(0).before_pause, 1.0) << cycle;
    EXPECT_EQ(places.at(1).before_pause, 2.0) << cycle;
    places.command(both(6.0 + cycle, 6.0));
  }
  EXPECT_EQ(places.at(0).before_pause, 8.0);
}

TEST(CommandedPlaces, ReachFromTheLastMissedCyclesAlone) {
  CommandedPlaces places(both(1.0, 1.0));
  places.coast();
  places.command(both(2.0, 2.0));
  places.coast();
  places.command(both(3.0, 3.0));
  EXPECT_EQ(places.at(0).before_pause, 2.0);
}

TEST(DistanceFrom, IsThatFromTheNearerEndOfTheWay) {
  for (const auto& [now, before] : {std::pair(1.0, 3.0), std::pair(3.0, 1.0)}) {
    EXPECT_EQ(distanceFrom({now, before}, 2.0), 0.0);
    EXPECT_EQ(distanceFrom({now, before}, 1.0), 0.0);
    EXPECT_EQ(distanceFrom({now, before}, 0.5), 0.5);
    EXPECT_EQ(distanceFrom({now, before}, 3.25), 0.25);
  }
}

}  // namespace
}  // namespace tactus
