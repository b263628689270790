#include "tactus/canopen/drive_setup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "support/drive_rig.h"

namespace tactus {
namespace {

using test::DriveRig;
using test::kNode;
using test::ScriptedDrive;
using Writes = std::vector<std::pair<ScriptedDrive::Entry, std::uint32_t>>;

bool isFailed(const DriveRig& rig) { return rig.report().fault != Fault::kNone; }

TEST(DriveSetup, WritesTheObjectsOfTheStandardsInOrder) {
  DriveRig rig;
  rig.configure();
  ASSERT_TRUE(rig.report().is_configured);
  const Writes expected = {{{0x6040, 0}, 0x0002},
                           {{0x1400, 1}, 0x80000205},
                           {{0x1600, 0}, 0},
                           {{0x1600, 1}, 0x60400010},
                           {{0x1600, 2}, 0x60FF0020},
                           {{0x1600, 0}, 2},
                           {{0x1400, 2}, 1},
                           {{0x1400, 5}, 60},
                           {{0x1800, 1}, 0x80000185},
                           {{0x1A00, 0}, 0},
                           {{0x1A00, 1}, 0x60410010},
                           {{0x1A00, 2}, 0x60640020},
                           {{0x1A00, 0}, 2},
                           {{0x1800, 2}, 1},
                           {{0x1801, 1}, 0x80000285},
                           {{0x1400, 1}, 0x00000205},
                           {{0x1800, 1}, 0x40000185},
                           {{0x6060, 0}, 9},
                           {{0x60C2, 1}, 1},
                           {{0x60C2, 2}, 0xFD},
                           {{0x607F, 0}, 4'400'001},
                           {{0x605A, 0}, 2},
                           {{0x605E, 0}, 2},
                           {{0x6007, 0}, 3},
                           {{0x1016, 1}, 127u << 16 | 60},
                           {{0x1017, 0}, 20}};
  EXPECT_EQ(rig.slave.writes, expected);
  EXPECT_EQ(rig.slave.nmt, 5);
  EXPECT_EQ(rig.slave.aborts_heard, 0);
}

TEST(DriveSetup, StartsPreOperationalAndSendsNoSetpointBeforeItIsDone) {
  DriveRig rig;
  const auto first = rig.cycle(DriveGoal::kConfigure, 0.0, true);
  EXPECT_EQ(first, (std::vector{test::rawFrame(0, {0x80, kNode})}));
  for (int cycle = 0; cycle < 200 && !rig.report().is_configured; ++cycle) {
    const auto frames = rig.cycle(DriveGoal::kConfigure);
    if (rig.report().is_configured) break;
    EXPECT_LE(frames.size(), 2u);
    for (const CanFrame& frame : frames)
      EXPECT_TRUE(frame.id == 0 || frame.id == 0x605) << frame.id;
  }
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_TRUE(rig.report().has_position);
}

TEST(DriveSetup, LeavesAPdoThatIsOffAsItIs) {
  DriveRig rig;
  rig.slave.objects[{0x1400, 1}] = 0x80000000;
  rig.slave.objects[{0x1801, 1}] = 0xC0000285;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1801, 1})], 0xC0000285u);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1400, 1})], 0x205u);
  EXPECT_EQ(rig.slave.writes.size(), 24u);
}

class DriveSetupStep : public testing::TestWithParam<SetupStep> {
 protected:
  ScriptedDrive::Entry entry() const { return {GetParam().entry.index, GetParam().entry.subindex}; }
  void expectRefused(DriveRig& rig, std::uint32_t code) {
    rig.configure();
    const DriveReport& report = rig.report();
    EXPECT_EQ(report.fault, Fault::kDriveSetupRefused);
    EXPECT_FALSE(report.is_configured);
    EXPECT_EQ(report.setup_failure.index, entry().first);
    EXPECT_EQ(report.setup_failure.subindex, entry().second);
    EXPECT_EQ(report.setup_failure.abort_code, code);
    rig.cycle(DriveGoal::kDisabled);  // an abort of a time-out
    for (DriveGoal goal : {DriveGoal::kConfigure, DriveGoal::kEnabled, DriveGoal::kQuickStop})
      EXPECT_TRUE(rig.cycle(goal).empty()) << "it is not ours to command";
    EXPECT_NE(rig.slave.nmt, 5);
  }
};

TEST_P(DriveSetupStep, RefusedEndsTheSetUpAndARestartMendsIt) {
  DriveRig rig;
  rig.slave.refused[entry()] = 0x08000022;
  if (GetParam().need < SetupStep::Need::kIfTaken) expectRefused(rig, 0x08000022);
  rig.slave.refused.clear();
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST_P(DriveSetupStep, MissingIsAcceptedOnlyWhereItMayBe) {
  for (std::uint32_t code : {0x06020000u, 0x06090011u}) {
    DriveRig rig;
    rig.slave.refused[entry()] = code;
    if (GetParam().need < SetupStep::Need::kIfThere) {
      expectRefused(rig, code);
    } else {
      rig.configure();
      EXPECT_TRUE(rig.report().is_configured);
    }
  }
}

TEST_P(DriveSetupStep, ReadOnlyIsAcceptedOnlyWhereItMayBe) {
  for (std::uint32_t code : {0x06010000u, 0x06010002u}) {
    DriveRig rig;
    rig.slave.refused[entry()] = code;
    if (GetParam().need < SetupStep::Need::kIfWritable) {
      expectRefused(rig, code);
    } else {
      rig.configure();
      EXPECT_TRUE(rig.report().is_configured);
    }
  }
}

/// A bus that still has to confirm frames takes none of that cycle.
TEST_P(DriveSetupStep, IsAskedForOnceMoreWhereItIsNotAnswered) {
  DriveRig rig;
  rig.slave.unanswered.insert(entry());
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.until([&] { return rig.slave.aborts_heard == 1; }, DriveGoal::kConfigure);
  rig.slave.unanswered.clear();
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST_P(DriveSetupStep, UnansweredEndsTheSetUp) {
  CanopenConfig canopen;
  const bool may_be_booting = GetParam().entry.index == 0x1000;
  if (may_be_booting) canopen.boot_timeout_s = 0.3;  // else it is not waited for
  DriveRig rig(test::driveConfig(), canopen);
  rig.slave.unanswered.insert(entry());
  expectRefused(rig, 0);
  EXPECT_GE(rig.slave.aborts_heard, 1);
  rig.slave.unanswered.clear();
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
}

TEST_P(DriveSetupStep, BeginsAnewAfterABootUpThere) {
  DriveRig rig;
  rig.slave.unanswered.insert(entry());
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(80, DriveGoal::kConfigure);
  rig.slave.unanswered.clear();
  rig.slave.powerUp();
  rig.slave.writes.clear();
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  EXPECT_EQ(rig.slave.writes.size(), 26u) << "all of it";
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

SetupSteps steps() { return setupSteps(test::driveConfig(), {}, 0.001); }

std::string stepName(const testing::TestParamInfo<SetupStep>& step) {
  std::ostringstream name;
  name << step.index << "_" << std::hex << step.param.entry.index << "_"
       << int{step.param.entry.subindex};
  return name.str();
}

INSTANTIATE_TEST_SUITE_P(Steps, DriveSetupStep, testing::ValuesIn(steps()), stepName);

TEST(DriveSetup, WaitsForADriveThatIsNotThereYet) {
  DriveRig rig;
  rig.slave.is_powered = false;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(4000, DriveGoal::kConfigure);
  EXPECT_FALSE(isFailed(rig));
  rig.slave.powerUp();
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure, 200);
}

TEST(DriveSetup, StopsWaitingAfterTheBootTimeout) {
  DriveRig rig;
  rig.slave.is_powered = false;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(4900, DriveGoal::kConfigure);
  EXPECT_FALSE(isFailed(rig));
  rig.until([&] { return isFailed(rig); }, DriveGoal::kConfigure, 300);
  EXPECT_EQ(rig.report().fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(rig.report().setup_failure.index, 0x1000);
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(4900, DriveGoal::kConfigure);
  EXPECT_FALSE(isFailed(rig)) << "it has as long again";
}

TEST(DriveSetup, StopsWaitingForADriveThatBootsForever) {
  CanopenConfig canopen;
  canopen.boot_timeout_s = 0.2;
  DriveRig rig(test::driveConfig(), canopen);
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  for (int cycle = 0; cycle < 300; ++cycle) {
    if (cycle % 5 == 0) rig.slave.powerUp();
    rig.cycle(DriveGoal::kConfigure);
  }
  EXPECT_EQ(rig.report().fault, Fault::kDriveSetupRefused);
}

TEST(DriveSetup, RefusesADeviceThatIsNoDrive) {
  DriveRig rig;
  rig.slave.objects[{0x1000, 0}] = 0x00020191;  // CiA 401: inputs and outputs
  rig.configure();
  EXPECT_EQ(rig.report().fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(rig.report().setup_failure.index, 0x1000);
}

TEST(DriveSetup, TakesDrivesOfAnyType) {
  for (const std::uint32_t type :
       {0x0001u, 0x0002u, 0x0004u, 0xFFFFu}) {  // inverter, servo, stepper
    DriveRig rig;
    rig.slave.objects[{0x1000, 0}] = type << 16 | 402;
    rig.configure();
    EXPECT_TRUE(rig.report().is_configured) << type;
  }
}

TEST(DriveSetup, RefusesAnotherProductAndSaysWhatItIs) {
  DriveConfig config = test::driveConfig();
  config.vendor_id = 0x12345678;
  config.product_code = 7;
  DriveRig rig(config);
  rig.slave.objects[{0x1018, 1}] = 0x12345678;
  rig.slave.objects[{0x1018, 2}] = 7;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  for (const int subindex : {1, 2}) {
    DriveRig other(config);
    other.slave.objects = rig.slave.objects;
    other.slave.objects[{0x1018, subindex}] = 8;
    other.slave.writes.clear();
    other.configure();
    const SetupFailure& failure = other.report().setup_failure;
    EXPECT_EQ(other.report().fault, Fault::kDriveSetupRefused);
    EXPECT_EQ(failure.index, 0x1018);
    EXPECT_EQ(failure.subindex, subindex);
    EXPECT_EQ(failure.abort_code, 0u);
    EXPECT_TRUE(failure.is_other_value);
    EXPECT_EQ(failure.value, 8u);
    EXPECT_EQ(failure.expected, subindex == 1 ? 0x12345678u : 7u);
    EXPECT_TRUE(other.slave.writes.empty()) << "what is not ours stays as it is";
  }
}

TEST(DriveSetup, SwitchesOffAllTransmitPdosThatItIsToldOf) {
  DriveConfig config = test::driveConfig();
  config.transmit_pdos = 7;
  DriveRig rig(config);
  rig.slave.objects[{0x1804, 1}] = 0x1C5;
  rig.slave.objects[{0x1806, 1}] = 0x2C5;
  rig.slave.objects[{0x1807, 1}] = 0x3C5;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1804, 1})], 0x800001C5u);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1806, 1})], 0x800002C5u);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1807, 1})], 0x3C5u);
}

/// Else any frame of such an id would command the drive.
TEST(DriveSetup, SwitchesOffTheReceivePdosThatItDoesNotUse) {
  DriveRig rig;
  rig.slave.objects[{0x1401, 1}] = 0x305;
  rig.slave.objects[{0x1402, 1}] = 0x80000405;
  rig.slave.objects[{0x1403, 1}] = 0x505;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1400, 1})], 0x205u);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1401, 1})], 0x80000305u);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x1403, 1})], 0x80000505u);
  EXPECT_EQ(rig.slave.writes.size(), 28u) << "one is off already";
}

/// A drive adds them to each setpoint: it would move as soon as it is enabled.
TEST(DriveSetup, ClearsTheOffsetsThatAMasterBeforeHasLeft) {
  DriveRig rig;
  rig.slave.objects[{0x60B1, 0}] = 0xFFFFFC18;
  rig.slave.objects[{0x60B2, 0}] = 70;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x60B1, 0})], 0u);
  EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x60B2, 0})], 0u);
}

TEST(DriveSetup, RefusesADriveWhoseOffsetStays) {
  DriveRig rig;
  rig.slave.objects[{0x60B1, 0}] = 1000;
  rig.slave.refused_writes[{0x60B1, 0}] = 0x06010002;
  rig.configure();
  EXPECT_FALSE(rig.report().is_configured);
  EXPECT_EQ(rig.report().setup_failure.index, 0x60B1);
  EXPECT_EQ(rig.report().setup_failure.abort_code, 0x06010002u);
}

/// Of drives that know milliseconds alone, or one period, the entries cannot be written.
TEST(DriveSetup, WritesOnlyWhatIsNotThere) {
  DriveRig rig;
  rig.slave.objects[{0x60C2, 1}] = 1;
  rig.slave.objects[{0x60C2, 2}] = 0xFD;
  rig.slave.refused_writes = {{{0x60B1, 0}, 0x06010002},
                              {{0x60B2, 0}, 0x06010002},
                              {{0x60C2, 1}, 0x06010002},
                              {{0x60C2, 2}, 0x06010002}};
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
}

TEST(DriveSetup, WritesWhatCannotBeReadWhereAllOfItIsTold) {
  for (const std::uint32_t code : {0x06010000u, 0x06010001u}) {
    DriveRig rig;
    for (const ScriptedDrive::Entry& entry :
         std::vector<ScriptedDrive::Entry>{{0x60B1, 0}, {0x60B2, 0}, {0x60C2, 1}, {0x60C2, 2}}) {
      rig.slave.objects[entry] = 77;
      rig.slave.refused_reads[entry] = code;
    }
    rig.configure();
    EXPECT_TRUE(rig.report().is_configured);
    EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x60B1, 0})], 0u);
    EXPECT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x60C2, 2})], 0xFDu);
  }
  DriveRig rig;
  rig.slave.refused_reads[{0x1400, 1}] = 0x06010001;
  rig.configure();
  EXPECT_FALSE(rig.report().is_configured) << "its other bits would be lost";
}

TEST(DriveSetup, LeavesOutAQuickStopOptionThatThereIsNot) {
  DriveConfig config = test::driveConfig();
  config.has_quick_stop_option = false;
  DriveRig rig(config);
  rig.slave.refused[{0x605A, 0}] = 0x06020000;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.slave.writes.size(), 25u);
}

/// Its own limit may be lower than the joint's, or it may not take one now.
TEST(DriveSetup, GoesOnWhereADriveTakesNoLimitOfSpeed) {
  for (const std::uint32_t code : {0x06020000u, 0x06010002u, 0x06090030u, 0x06090031u, 0x06070010u,
                                   0x08000022u, 0x08000000u}) {
    DriveRig rig;
    rig.slave.refused[{0x607F, 0}] = code;
    rig.configure();
    EXPECT_TRUE(rig.report().is_configured) << std::hex << code;
    EXPECT_EQ(rig.report().fault, Fault::kNone);
  }
}

TEST(DriveSetup, RefusesADriveThatDoesNotTakeTheMode) {
  DriveRig rig;
  rig.slave.shows_mode = false;
  rig.configure();
  EXPECT_EQ(rig.report().fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(rig.report().setup_failure.index, 0x6061);
}

/// Drives of several vendors come with 60FF in turns a minute, which would be some hundred times as
/// fast as what was meant.
TEST(DriveSetup, RefusesADriveWhoseVelocitiesAreNotCounts) {
  constexpr std::uint32_t kCountsPerSecond = 0x00B50300;
  for (const std::uint32_t unit : {0x00B44700u, 0xFDB44700u, 0x00B40300u, 0xFDB50300u}) {
    DriveRig rig;
    rig.slave.objects[{0x60A9, 0}] = unit;
    rig.configure();
    EXPECT_FALSE(rig.report().is_configured) << std::hex << unit;
    EXPECT_EQ(rig.report().fault, Fault::kDriveSetupRefused);
    EXPECT_EQ(rig.report().setup_failure.index, 0x60A9);
    EXPECT_EQ(rig.report().setup_failure.value, unit);
    EXPECT_EQ(rig.report().setup_failure.expected, kCountsPerSecond);
  }
  DriveRig rig;
  rig.slave.objects[{0x60A9, 0}] = kCountsPerSecond;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
}

TEST(DriveSetup, DoesNotAskForAUnitThatAProfileSaysMeansNothing) {
  DriveConfig config = test::driveConfig();
  config.has_velocity_unit = false;
  DriveRig rig(config);
  rig.slave.objects[{0x60A9, 0}] = 0x00B44700;
  rig.configure();
  EXPECT_TRUE(rig.report().is_configured);
}

TEST(DriveSetup, WaitsForADriveThatShowsItsModeLate) {
  DriveRig rig;
  rig.slave.shows_mode = false;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(60, DriveGoal::kConfigure);
  ASSERT_EQ(rig.slave.objects[(ScriptedDrive::Entry{0x6060, 0})], 9u);
  rig.slave.objects[{0x6061, 0}] = 9;
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
}

TEST(DriveSetup, IsSilentWhenTheDriveDoesNotRunAfterwards) {
  for (bool without_feedback : {false, true}) {
    DriveRig rig;
    rig.slave.sends_feedback = !without_feedback;
    rig.slave.sends_heartbeat = without_feedback;
    rig.configure();
    EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
    EXPECT_STREQ(rig.report().detail.unit,
                 without_feedback ? "cycles without feedback" : "cycles without heartbeat");
    EXPECT_FALSE(rig.report().is_configured);
  }
}

/// One that does not hear it says so by its heartbeat, and is told again as often as that.
TEST(DriveSetup, RepeatsAStartThatTheDriveHasNotHeard) {
  const CanFrame start = test::rawFrame(0, {0x01, kNode});
  for (const int lost : {0, 1, 3, 1000}) {
    SCOPED_TRACE(lost);
    DriveRig rig;
    rig.cycle(DriveGoal::kConfigure, 0.0, true);
    int starts = 0;
    for (int i = 0; i < 500 && !rig.report().is_configured && !isFailed(rig); ++i) {
      rig.slave.ignores_nmt = starts < lost;  // the one that is sent in this cycle, if it is
      for (const CanFrame& frame : rig.cycle(DriveGoal::kConfigure)) starts += frame == start;
    }
    EXPECT_EQ(rig.report().is_configured, lost <= 3);
    EXPECT_GE(starts, std::min(lost, 3) + 1);
    EXPECT_LE(starts, std::min(lost, 8) + 2) << "one that came just as it was told";
    EXPECT_EQ(rig.report().fault, lost <= 3 ? Fault::kNone : Fault::kDriveSilent);
  }
}

TEST(DriveSetup, BelievesNothingOfBeforeTheStart) {
  DriveRig rig;
  rig.enable();
  rig.slave.sends_heartbeat = false;
  rig.configure();
  EXPECT_EQ(rig.report().fault, Fault::kDriveSilent) << "its heartbeat was that of before";
}

TEST(DriveSetup, BeginsAnewAfterABootUpAtTheEnd) {
  DriveRig rig;
  rig.slave.sends_heartbeat = false;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.until([&] { return rig.report().has_position; }, DriveGoal::kConfigure);
  rig.slave.sends_heartbeat = true;
  rig.slave.sends_feedback = false;
  rig.slave.powerUp();
  rig.slave.writes.clear();
  rig.cycles(150, DriveGoal::kConfigure);
  EXPECT_EQ(rig.slave.writes.size(), 26u);
  EXPECT_FALSE(rig.report().is_configured) << "its feedback was that of before";
  rig.slave.sends_feedback = true;
  rig.cycles(2, DriveGoal::kConfigure);
  EXPECT_TRUE(rig.report().is_configured);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST(DriveSetup, GoesOnOnlyWhileAskedTo) {
  DriveRig rig;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(5, DriveGoal::kConfigure);
  for (DriveGoal goal : {DriveGoal::kSilent, DriveGoal::kDisabled, DriveGoal::kEnabled})
    for (int cycle = 0; cycle < 50; ++cycle) EXPECT_TRUE(rig.cycle(goal, 1.0).empty());
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
}

TEST(DriveSetup, StopsADriveThatStillMovesForAMasterThatHasGone) {
  DriveRig rig;
  rig.slave.power = ScriptedDrive::kEnabled;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(4, DriveGoal::kConfigure);
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kQuickStop);
  rig.slave.quick_stop_cycles = 1;
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().state, DriveState::kSwitchOnDisabled);
}

/// What it was told before is gone; waiting for an answer to that would take its time-out.
TEST(DriveSetup, BeginsAnewAtOnceWhenTheDriveBoots) {
  DriveRig rig;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(10, DriveGoal::kConfigure);
  rig.slave.say(0x700, {0});
  bool is_told = false;
  for (int i = 0; i < 3; ++i)
    for (const CanFrame& frame : rig.cycle(DriveGoal::kConfigure))
      is_told |= frame == test::rawFrame(0, {0x80, kNode});
  EXPECT_TRUE(is_told);
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
}

/// Its boot-up may be lost.
TEST(DriveSetup, AsksADriveAgainThatIsThereLateWithoutSayingSo) {
  DriveRig rig;
  rig.slave.unanswered.insert({0x1000, 0});
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(250, DriveGoal::kConfigure);
  rig.slave.unanswered.clear();
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure, 200);
}

/// One that was refused, or did not run, is not commanded by what it says later.
TEST(DriveSetup, LeavesADriveAloneThatItHasGivenUp) {
  for (const bool is_refused : {false, true}) {
    DriveRig rig;
    if (is_refused) rig.slave.refused[{0x6060, 0}] = 0x08000022;
    rig.slave.sends_feedback = is_refused;
    rig.configure();
    const Fault fault = rig.report().fault;
    EXPECT_EQ(fault, is_refused ? Fault::kDriveSetupRefused : Fault::kDriveSilent);
    rig.slave.refused.clear();
    rig.slave.sends_feedback = true;
    if (is_refused) rig.slave.powerUp();
    for (int cycle = 0; cycle < 300; ++cycle) {
      EXPECT_TRUE(rig.cycle(DriveGoal::kConfigure).empty()) << cycle;
      ASSERT_FALSE(rig.report().is_configured) << cycle;
    }
    EXPECT_EQ(rig.report().fault, fault);
  }
}

/// Whoever needs no second start gets none: not one that runs, nor one that says nothing.
TEST(DriveSetup, StartsADriveOnceThatDoesNotAskForIt) {
  for (const bool is_heard : {false, true}) {
    DriveRig rig;
    rig.slave.sends_feedback = false;
    rig.slave.sends_heartbeat = is_heard;
    int starts = 0;
    const auto cycle = [&](bool restart) {
      for (const CanFrame& frame : rig.cycle(DriveGoal::kConfigure, 0.0, restart))
        starts += frame == test::rawFrame(0, {0x01, kNode});
    };
    cycle(true);
    for (int i = 0; i < 500 && starts == 0; ++i) cycle(false);
    if (!is_heard) {  // the question is of a start before
      rig.slave.say(0x700, {127});
      starts = 0;
      cycle(true);
    }
    for (int i = 0; i < 500; ++i) cycle(false);
    EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
    EXPECT_EQ(starts, 1) << is_heard;
  }
}

TEST(DriveSetup, SaysNothingBeforeItsStartNorAfterItsEnd) {
  CanopenConfig canopen;
  canopen.boot_timeout_s = 0.02;
  DriveSetup setup(test::driveConfig(), canopen, 0.001);
  const auto framesOf = [&setup](int cycles) {
    std::size_t frames = 0;
    for (int i = 0; i < cycles; ++i) {
      FrameBatch out;
      setup.update(out);
      frames += out.size();
    }
    return frames;
  };
  EXPECT_EQ(framesOf(10), 0u);
  setup.start();
  EXPECT_GT(framesOf(200), 0u);
  EXPECT_EQ(setup.status(), DriveSetup::Status::kFailed);
  EXPECT_EQ(setup.failure().index, 0x1000);
  EXPECT_EQ(framesOf(200), 0u);
  setup.start();
  EXPECT_EQ(setup.failure().index, 0) << "of the set-up that is under way";
}

}  // namespace
}  // namespace tactus
