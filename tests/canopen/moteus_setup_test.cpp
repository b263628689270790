#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "support/moteus_rig.h"

/// What a moteus has to say before it is commanded, and for how long it is waited for.
namespace tactus {
namespace {

using test::kMoteusNode;
using test::moteusConfig;
using test::moteusReply;
using test::MoteusRig;

/// A reply to a command that did not ask for it.
CanFrame withoutMap(CanFrame reply) {
  reply.size = static_cast<std::uint8_t>(reply.size - 7);
  return reply;
}

/// What is not as it has to be is named: by it a user knows what to mend.
TEST(MoteusSetup, NamesTheRegisterThatKeepsItFromItsSetUp) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr int kOtherMap = kMoteusMap + 1;
  struct Refused {
    std::optional<CanFrame> reply;
    SetupFailure failure;
  };
  const auto other = [](std::uint16_t number, int value, int expected) {
    return SetupFailure{number,
                        0,
                        0,
                        true,
                        static_cast<std::uint32_t>(value),
                        static_cast<std::uint32_t>(expected)};
  };
  const Refused all[] = {
      {moteusReply(0, 0.0F, 0.0F, 0, kOtherMap),
       other(moteus_register::kMapVersion, kOtherMap, kMoteusMap)},
      {withoutMap(moteusReply(0, 0.0F, 0.0F, 0)), {moteus_register::kMapVersion, 0, 0}},
      {moteusReply(5, 0.0F, 0.0F, 33, kOtherMap),
       other(moteus_register::kMapVersion, kOtherMap, kMoteusMap)},
      {moteusReply(0, 0.0F, 0.0F, 0, kMoteusMap, 1), other(moteus_register::kHome, 1, 2)},
      {moteusReply(1, 0.0F, 0.0F, 33), other(moteus_register::kFault, 33, 0)},
      {moteusReply(5, 0.0F, 0.0F, 0), other(moteus_register::kMode, 5, 0)},
      {moteusReply(0, kNaN, 0.0F, 0), {moteus_register::kPosition, 0, 0}},
      {std::nullopt, {moteus_register::kPosition, 0, 0}}};
  CanopenConfig canopen;
  canopen.boot_timeout_s = 0.02;
  for (const Refused& refused : all) {
    MoteusRig rig{MoteusDrive(moteusConfig(), canopen, test::kPeriod_s)};
    for (int i = 0; i < 30; ++i) {
      if (refused.reply) rig.drive.receive(*refused.reply);
      rig.quietCycle(DriveGoal::kConfigure, 0.0, i == 0);
    }
    const SetupFailure& failure = rig.drive.report().setup_failure;
    SCOPED_TRACE(refused.failure.index);
    EXPECT_EQ(rig.drive.report().fault, Fault::kDriveSetupRefused);
    EXPECT_FALSE(rig.drive.report().is_configured);
    EXPECT_EQ(failure.index, refused.failure.index);
    EXPECT_EQ(failure.subindex, 0);
    EXPECT_EQ(failure.abort_code, 0u);
    EXPECT_EQ(failure.is_other_value, refused.failure.is_other_value);
    EXPECT_EQ(failure.value, refused.failure.value);
    EXPECT_EQ(failure.expected, refused.failure.expected);
  }
}

TEST(MoteusSetup, ThatDoesNotAnswerIsWaitedForToTheCycle) {
  CanopenConfig canopen;
  canopen.boot_timeout_s = 0.02;
  MoteusRig rig{MoteusDrive(moteusConfig(), canopen, test::kPeriod_s)};
  for (int start = 0; start < 2; ++start) {  // each has all of it
    rig.quietCycle(DriveGoal::kConfigure, 0.0, true);
    for (int i = 0; i < 20; ++i) {
      rig.quietCycle(DriveGoal::kConfigure);
      ASSERT_EQ(rig.drive.report().fault, Fault::kNone) << i;
    }
    rig.quietCycle(DriveGoal::kConfigure);
    EXPECT_EQ(rig.drive.report().fault, Fault::kDriveSetupRefused);
  }
  rig.quietCycle(DriveGoal::kConfigure, 0.0, true);
  for (int i = 0; i < 20; ++i) rig.quietCycle(DriveGoal::kConfigure);
  rig.cycle(DriveGoal::kConfigure);
  EXPECT_TRUE(rig.drive.report().is_configured) << "in the last of its cycles";
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
}

/// One that was refused is not commanded by what it replies later.
TEST(MoteusSetup, ThatIsRefusedIsLeftAlone) {
  CanopenConfig canopen;
  canopen.boot_timeout_s = 0.02;
  MoteusRig rig{MoteusDrive(moteusConfig(), canopen, test::kPeriod_s)};
  rig.quietCycle(DriveGoal::kConfigure, 0.0, true);
  for (int i = 0; i < 30; ++i) rig.quietCycle(DriveGoal::kConfigure);
  ASSERT_EQ(rig.drive.report().fault, Fault::kDriveSetupRefused);
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(rig.cycle(DriveGoal::kConfigure).mode, -2);
    EXPECT_FALSE(rig.drive.report().is_configured);
  }
}

/// It is asked while it is set up, where one that is answered once suffices, as the newest of it.
TEST(MoteusSetup, KnowsTheMapThatItWasLastTold) {
  constexpr int kOtherMap = kMoteusMap + 1;
  MoteusRig rig;
  rig.quietCycle(DriveGoal::kConfigure, 0.0, true);
  const auto isReadyAfter = [&rig](const CanFrame& reply) {
    rig.drive.receive(reply);
    rig.quietCycle(DriveGoal::kConfigure);
    return rig.drive.report().is_configured;
  };
  EXPECT_FALSE(isReadyAfter(withoutMap(moteusReply(0, 0.0F, 0.0F, 0))));
  EXPECT_FALSE(isReadyAfter(moteusReply(0, 0.0F, 0.0F, 0, kOtherMap)));
  EXPECT_FALSE(isReadyAfter(withoutMap(moteusReply(0, 0.0F, 0.0F, 0))));
  EXPECT_FALSE(isReadyAfter(moteusReply(1, 0.0F, 0.0F, 33)));
  EXPECT_TRUE(isReadyAfter(withoutMap(moteusReply(0, 0.0F, 0.0F, 0))));
  MoteusRig other;
  other.quietCycle(DriveGoal::kConfigure, 0.0, true);
  other.drive.receive(moteusReply(0, 0.0F, 0.0F, 0, kOtherMap));
  other.quietCycle(DriveGoal::kConfigure);
  other.cycle(DriveGoal::kConfigure);
  EXPECT_TRUE(other.drive.report().is_configured) << "the newest counts";
}

TEST(MoteusSetup, IsAskedForItsMapInItsSetUpAlone) {
  const auto asksForMap = [](MoteusRig& rig, DriveGoal goal, bool restart) {
    FrameBatch out;
    rig.drive.receive(moteusReply(0, 0.0F, 0.0F, 0));
    rig.drive.observe({rig.position, rig.position});
    rig.drive.update(goal, restart, 0.0, rig.position, out);
    const auto isOf = [&out](bool asks) {
      for (const auto kind : {MoteusCommand::Kind::kQuery, MoteusCommand::Kind::kStop})
        if (*out.begin() == moteusCommandFrame(kMoteusNode, {.kind = kind, .asks_for_setup = asks}))
          return true;
      return false;
    };
    EXPECT_EQ(out.size(), 1u);
    EXPECT_NE(isOf(true), isOf(false));
    return isOf(true);
  };
  MoteusRig rig;
  EXPECT_TRUE(asksForMap(rig, DriveGoal::kConfigure, true));
  EXPECT_FALSE(asksForMap(rig, DriveGoal::kConfigure, false)) << "it is set up";
  EXPECT_TRUE(rig.drive.report().is_configured);
}

/// What nobody asked for says nothing.
TEST(MoteusSetup, IsNotHeardBeforeItsSetUp) {
  MoteusRig rig;
  rig.cycles(10, DriveGoal::kDisabled);
  EXPECT_FALSE(rig.drive.report().has_position);
  EXPECT_FALSE(rig.drive.report().has_state);
  EXPECT_FALSE(rig.drive.report().is_off);
}

}  // namespace
}  // namespace tactus
