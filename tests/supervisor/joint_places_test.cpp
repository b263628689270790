#include "tactus/supervisor/joint_places.h"

#include <gtest/gtest.h>

#include <limits>

namespace tactus {
namespace {

HardwareConfig twoDrives() {
  HardwareConfig hardware;
  hardware.drives.resize(2);
  hardware.start_tolerance = 0.02;
  return hardware;
}

JointVector places(double first, double second) { return Eigen::Vector2d(first, second); }

TEST(JointPlaces, AreTheStartAtFirst) {
  const JointPlaces joints(places(1.0, -1.0), twoDrives());
  EXPECT_EQ(joints.outOfPlace(places(1.019, -1.019)), -1);
  EXPECT_EQ(joints.outOfPlace(places(1.021, -1.0)), 0);
  EXPECT_EQ(joints.outOfPlace(places(1.03, -1.04)), 1) << "the farthest";
  EXPECT_GE(joints.outOfPlace(places(1.0, std::numeric_limits<double>::quiet_NaN())), 0);
}

TEST(JointPlaces, FollowAJointAsLongAsItsDriveHoldsIt) {
  JointPlaces joints(places(0, 0), twoDrives());
  joints.command(places(0.5, 0.5), places(0.2, 0.2));
  joints.observe(0, 0.55, true, false);
  joints.observe(1, 0.55, false, false);  // says nothing
  EXPECT_EQ(joints.outOfPlace(places(0.56, 0.5)), -1);
  EXPECT_EQ(joints.outOfPlace(places(0.56, 0.56)), 1);
  joints.observe(0, 0.56, false, true);  // let go
  joints.observe(0, 0.6, true, false);   // and held again: somebody may have pushed it
  EXPECT_EQ(joints.outOfPlace(places(0.6, 0.5)), 0);
  joints.command(places(0.6, 0.5), places(0, 0));
  EXPECT_EQ(joints.outOfPlace(places(0.6, 0.5)), -1);
}

TEST(JointPlaces, AreAsWideAsTheirTolerance) {
  JointPlaces joints(places(0, 0), twoDrives());
  EXPECT_EQ(joints.outOfPlace(places(0.02, -0.02)), -1);
  joints.command(places(0, 0), places(0.25, 0.25));
  const double longest = CanopenConfig{}.stop_deadline_s * 0.25 + DriveConfig{}.max_following_error;
  joints.observe(0, longest, true, false);
  EXPECT_EQ(joints.outOfPlace(places(longest, 0.0)), -1) << "just as far as a stop may lead";
}

TEST(JointPlaces, EndWhereNoStopLeadsTo) {
  JointPlaces joints(places(0, 0), twoDrives());
  joints.command(places(0, 0), places(0.1, 0.1));
  const double longest = CanopenConfig{}.stop_deadline_s * 0.1 + DriveConfig{}.max_following_error;
  joints.observe(0, 0.99 * longest, true, false);
  joints.observe(1, 1.01 * longest, true, false);
  EXPECT_EQ(joints.outOfPlace(places(0.99 * longest, 0.0)), -1);
  EXPECT_EQ(joints.outOfPlace(places(0.0, 1.01 * longest)), 1);
}

/// A drive that heard nothing in missed cycles has stopped where they began, or on the way since.
/// Its feedback may be late by a cycle.
TEST(JointPlaces, FollowAStopThatBeganBeforeMissedCycles) {
  const double longest = CanopenConfig{}.stop_deadline_s * 0.2 + DriveConfig{}.max_following_error;
  const JointVector before = places(0.5, 0.5), after = places(2.5, 2.5),
                    velocity = places(0.2, 0.2);
  for (const double stopped : {0.5 - 0.99 * longest, 0.5, 1.5, 2.5, 2.5 + 0.99 * longest}) {
    for (const int late_cycles : {0, 1}) {
      JointPlaces joints(places(0, 0), twoDrives());
      joints.command(before, velocity);
      joints.coast();
      for (int i = 0; i <= late_cycles; ++i) joints.command(after, velocity);
      joints.observe(0, stopped, true, false);
      joints.observe(1, 0.5 - 1.01 * longest, true, false);
      EXPECT_EQ(joints.outOfPlace(places(stopped, 2.5)), -1) << stopped << ", " << late_cycles;
      EXPECT_EQ(joints.outOfPlace(places(2.5, 0.5 - 1.01 * longest)), 1);
      for (int i = 0; i < 2; ++i) joints.command(after, velocity);
      joints.observe(1, 1.5, true, false);
      EXPECT_EQ(joints.outOfPlace(places(2.5, 1.5)), 1) << "no feedback is that late";
    }
  }
}

TEST(JointPlaces, AreTheCommandedOnesWhereAJointIsDoubted) {
  JointPlaces joints(places(0, 0), twoDrives());
  joints.command(places(0.5, 0.5), places(0.2, 0.2));
  joints.observe(0, 0.45, true, false);
  joints.observe(1, 0.45, true, false);
  joints.doubt(0);
  joints.observe(0, 0.45, true, false);
  EXPECT_EQ(joints.outOfPlace(places(0.5, 0.45)), -1);
  EXPECT_EQ(joints.outOfPlace(places(0.45, 0.45)), 0);
}

}  // namespace
}  // namespace tactus
