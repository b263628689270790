#include "tactus/canopen/can_frame.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "support/scripted_drive.h"
#include "tactus/canopen/can_robot.h"
#include "tactus/canopen/cia402.h"

namespace tactus {
namespace {

TEST(CanFrame, ABatchRefusesWhatItHasNoPlaceFor) {
  FrameBatch batch;
  std::size_t taken = 0;
  while (taken < 10000 && batch.push(test::rawFrame(0x100, {static_cast<int>(taken % 256)})))
    ++taken;
  ASSERT_LT(taken, 10000u);
  ASSERT_GT(taken, 0u);
  EXPECT_EQ(batch.size(), taken);
  EXPECT_EQ(batch.frames().back().data[0], (taken - 1) % 256) << "what is there stays";
  batch.clear();
  EXPECT_TRUE(batch.empty());
  EXPECT_TRUE(batch.push(test::rawFrame(0x100, {1})));
}

TEST(CanFrame, StatesOfDrivesHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (int state = 0; state <= static_cast<int>(DriveState::kFault); ++state)
    names.insert(driveStateName(static_cast<DriveState>(state)));
  EXPECT_EQ(names.size(), 8u);
  EXPECT_FALSE(names.contains(""));
}

TEST(CanFrame, ARobotCountsTheMalformedOnesOfAllItsDrives) {
  HardwareConfig hardware;
  hardware.buses.resize(2);
  for (int i = 0; i < 3; ++i) {
    hardware.drives.emplace_back();
    hardware.drives.back().joint = i;
    hardware.drives.back().bus = i / 2;
    hardware.drives.back().node_id = i + 1;
  }
  CanRobot robot(hardware, 0.001);
  const CanFrame wrong[] = {test::rawFrame(0x701, {}), test::rawFrame(0x182, {0, 0}),
                            test::rawFrame(0x703, {5, 5})};
  robot.receive(0, wrong);  // the third is of a drive on the other bus
  EXPECT_EQ(robot.malformedFrames(), 2);
  robot.receive(1, wrong);
  EXPECT_EQ(robot.malformedFrames(), 3);
}

}  // namespace
}  // namespace tactus
