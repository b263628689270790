#include "tactus/canopen/can_frame.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "support/scripted_drive.h"
#include "tactus/canopen/can_robot.h"
#include "tactus/canopen/cia402.h"
#include "tactus/canopen/sdo_abort.h"

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

/// All codes of CiA 301 (table 22), each by a name of its own.
TEST(CanFrame, AbortCodesAreThoseOfTheStandard) {
  std::set<std::uint32_t> standard{0x05030000, 0x06010000, 0x06010001, 0x06010002, 0x06020000,
                                   0x06040041, 0x06040042, 0x06040043, 0x06040047, 0x06060000,
                                   0x06070010, 0x06070012, 0x06070013, 0x06090011, 0x06090030,
                                   0x06090031, 0x06090032, 0x06090036, 0x060A0023, 0x08000000};
  for (std::uint32_t i = 0; i <= 5; ++i) standard.insert(0x05040000 + i);
  for (std::uint32_t i = 0; i <= 4; ++i) standard.insert(0x08000020 + i);
  std::set<std::uint32_t> codes;
  std::set<std::string> names;
  for (const SdoAbortRow& row : sdoAbortTable()) {
    codes.insert(row.code);
    names.insert(sdoAbortName(row.code));
    EXPECT_STREQ(sdoAbortName(row.code), row.name);
  }
  EXPECT_EQ(codes, standard);
  EXPECT_EQ(names.size(), standard.size());
  EXPECT_FALSE(names.contains(sdoAbortName(1)));
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
