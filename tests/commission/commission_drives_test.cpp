#include <gtest/gtest.h>

#include <set>

#include "support/troubled_commission.h"

/// What the drives themselves have to say while a joint is commissioned: of their set-up, and of
/// their counts.
namespace tactus {
namespace {

using test::TroubledRig;

/// At this object, before the drive had power. Returns what was refused.
SetupFailure expectSetUpRefused(TroubledRig& rig, std::uint16_t index) {
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kStroke);
  EXPECT_EQ(trouble.stroke.fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(trouble.stroke.drive.setup_failure.index, index);
  EXPECT_EQ(rig.most_powered, 0);
  return trouble.stroke.drive.setup_failure;
}

TEST(CommissionDrive, DriveThatRefusesItsSetUp) {
  TroubledRig rig;
  rig.on_send = [&rig](int bus, CanFrame& frame) {
    if (frame.id != 0x602 || test::sdoIndex(frame) != 0x6060) return true;
    rig.own_answers.emplace_back(bus, test::sdoAnswer(2, frame, 0x80, 0x06090030));
    return false;
  };
  EXPECT_EQ(expectSetUpRefused(rig, 0x6060).abort_code, 0x06090030u);
}

/// By its data sheet and its profile.
TEST(CommissionDrive, DriveIsSetUpAsByTheDaemon) {
  TroubledRig rig;
  DriveConfig& drive = rig.config.hardware.drives[test::kTroubledJoint];
  drive.has_quick_stop_option = drive.has_velocity_unit = false;
  drive.vendor_id = 0x7ac;
  drive.product_code = 1;
  drive.transmit_pdos = 6;
  std::set<std::uint16_t> asked;
  rig.on_send = [&](int, CanFrame& frame) {
    if (frame.id == 0x602) asked.insert(test::sdoIndex(frame));
    return true;
  };
  rig.restart();
  ASSERT_TRUE(rig.scan());
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
  test::expectFound(rig, rig.cycle->joint()->findings());
  EXPECT_FALSE(asked.contains(0x605A));
  EXPECT_FALSE(asked.contains(0x60A9));
  EXPECT_TRUE(asked.contains(0x1805));
}

TEST(CommissionDrive, DriveOfAnotherProductIsNotMoved) {
  TroubledRig rig;
  rig.config.hardware.drives[test::kTroubledJoint].product_code = 2;
  rig.restart();
  ASSERT_TRUE(rig.scan());
  EXPECT_EQ(expectSetUpRefused(rig, 0x1018).expected, 2u);
}

TEST(CommissionDrive, DrivesOwnCountsAreTakenWhereMarksConfirmThem) {
  constexpr double kTurn = 6.283185307179586;
  for (const bool is_right : {true, false}) {
    TroubledRig rig;
    const auto per_turn = static_cast<std::uint32_t>(std::lround(4e5 * kTurn * (is_right ? 1 : 3)));
    rig.on_send = [&](int bus, CanFrame& frame) {
      const std::uint16_t index = frame.id == 0x602 ? test::sdoIndex(frame) : std::uint16_t{0};
      if (index != 0x608F && index != 0x6091) return true;
      const bool is_counts = index == 0x608F && frame.data[3] == 1;
      rig.own_answers.emplace_back(bus, test::sdoAnswer(2, frame, 0x43, is_counts ? per_turn : 1));
      return false;
    };
    rig.restart();
    ASSERT_TRUE(rig.scan());
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
    const JointFindings& found = rig.cycle->joint()->findings();
    EXPECT_NEAR(found.drive_counts_per_unit.value_or(0.0), per_turn / kTurn, 1e-6);
    EXPECT_EQ(found.source, is_right ? ScaleSource::kDrive : ScaleSource::kMeasured);
    EXPECT_NEAR(found.scale.counts_per_unit, 4e5, is_right ? 1.0 : 4e4);
    test::expectFound(rig, found);
  }
}

/// Of the encoder's resolution and the gear: refused, not answered at all, never set, or without
/// the gear of 160 that is behind the drive. The file has them.
TEST(CommissionDrive, DriveThatDoesNotTellItsCountsIsUsable) {
  constexpr std::uint32_t kNone = 0;
  struct Told {
    bool is_silent;
    std::uint32_t per_turn;
  };
  for (const Told told :
       {Told{false, kNone}, Told{true, kNone}, Told{false, 1}, Told{false, 15708}}) {
    SCOPED_TRACE(testing::Message() << told.is_silent << " " << told.per_turn);
    TroubledRig rig;
    rig.on_send = [&](int bus, CanFrame& frame) {
      const std::uint16_t index = frame.id == 0x602 ? test::sdoIndex(frame) : std::uint16_t{0};
      if (index != 0x608F && index != 0x6091) return true;
      if (told.is_silent) return false;
      const bool is_counts = index == 0x608F && frame.data[3] == 1;
      const std::uint32_t value = is_counts ? told.per_turn : 1;
      rig.own_answers.emplace_back(bus, told.per_turn == kNone
                                            ? test::sdoAnswer(2, frame, 0x80, 0x06020000)
                                            : test::sdoAnswer(2, frame, 0x43, value));
      return false;
    };
    rig.restart();
    ASSERT_TRUE(rig.scan());
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
    test::expectFound(rig, rig.cycle->joint()->findings());
    EXPECT_LE(rig.worst_travel, 1.0 + 1e-3);
  }
}

}  // namespace
}  // namespace tactus
