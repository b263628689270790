#include "tactus/plant/moteus_slave.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tactus/canopen/moteus_frames.h"

namespace tactus {
namespace {

constexpr std::int64_t kOneMs = 1'000'000;

class MoteusOfNode3 : public testing::Test {
 protected:
  MoteusOfNode3() { slave_.setPowered(true, 0); }

  static DriveConfig config() {
    DriveConfig config;
    config.kind = DriveKind::kMoteus;
    config.node_id = 3;
    config.counts_per_unit = 0.25;
    config.sign = -1;
    config.offset = 0.5;
    return config;
  }

  MoteusReply ask(const MoteusCommand& command) {
    slave_.receive({moteusCommandFrame(3, command), t_ns_}, t_ns_);
    EXPECT_EQ(slave_.outbox().size(), 1u);
    const auto reply = decodeMoteusReply(*slave_.outbox().begin(), 3);
    slave_.outbox().clear();
    EXPECT_TRUE(reply);
    return reply.value_or(MoteusReply{});
  }
  /// A reply is of what was before the command.
  MoteusReply after(const MoteusCommand& command) {
    ask(command);
    return ask({});
  }
  MoteusReply run(float velocity = 0.1F) {
    return ask({.kind = MoteusCommand::Kind::kVelocity, .velocity = velocity, .watchdog_s = 0.05F});
  }
  void wait(int ms) {
    for (int i = 0; i < ms; ++i) {
      t_ns_ += kOneMs;
      slave_.update(t_ns_);
      slave_.move(0.001);
    }
  }

  MoteusSlave slave_{config(), 0.001};
  std::int64_t t_ns_ = 0;
};

/// Counts up to 2^32 are a few bytes, and any number may stand in for a mode.
TEST_F(MoteusOfNode3, DoesNotAnswerBeyondAFrameWhateverIsAsked) {
  CanFrame frame = moteusCommandFrame(3, {});
  for (const std::uint8_t last : std::to_array<std::uint8_t>({1, 4, 7, 8, 12, 15})) {
    for (const std::uint8_t type : std::to_array<std::uint8_t>({0x10, 0x14, 0x18, 0x1C})) {
      frame.data = {type, 0x80, 0x80, 0x80, 0x80, last, 0x00};
      frame.size = 7;
      slave_.receive({frame, t_ns_}, t_ns_);
      EXPECT_TRUE(slave_.outbox().empty()) << int{type} << " " << int{last};
    }
  }
  frame.data = {0x0D, 0x00, 0x00, 0x00, 0xC0, 0x7F};  // mode: a float that is NaN
  frame.size = 6;
  slave_.receive({frame, t_ns_}, t_ns_);
  EXPECT_EQ(slave_.mode(), 0);
}

TEST_F(MoteusOfNode3, TellsWhereItIsAndWhatItIs) {
  slave_.setPosition(2.5);
  const MoteusReply reply = ask({.asks_for_setup = true});
  EXPECT_EQ(reply.mode, 0);
  EXPECT_NEAR(reply.position, -0.5, 1e-6);
  EXPECT_EQ(reply.map, kMoteusMap);
  EXPECT_EQ(reply.home, 2);
  EXPECT_EQ(reply.fault, 0);
}

TEST_F(MoteusOfNode3, FollowsAVelocityOnceItIsEnabled) {
  EXPECT_EQ(run().mode, 0);
  EXPECT_EQ(slave_.mode(), 2);
  EXPECT_EQ(slave_.powerState(), PowerState::kSwitchedOn);
  wait(4);
  EXPECT_EQ(run().mode, 10);
  wait(1);
  EXPECT_NEAR(slave_.velocity(), -0.4, 1e-6);
  EXPECT_NEAR(run().velocity, 0.1, 1e-6);
}

TEST_F(MoteusOfNode3, StopsByItselfWithoutCommandsAndOnlyStopLeadsOn) {
  run();
  wait(4);
  run();
  wait(40);
  EXPECT_EQ(ask({}).mode, 10) << "asking is no command";
  wait(20);
  EXPECT_EQ(slave_.mode(), 11);
  wait(50);
  EXPECT_EQ(slave_.velocity(), 0.0);
  EXPECT_EQ(run().mode, 11);
  EXPECT_EQ(after({.kind = MoteusCommand::Kind::kStop}).mode, 0);
  run();
  EXPECT_EQ(slave_.mode(), 2);
}

TEST_F(MoteusOfNode3, RollsOnWhereItIsToldToLetGoInMotion) {
  run();
  wait(4);
  run();
  wait(1);
  ask({.kind = MoteusCommand::Kind::kStop});
  wait(100);
  EXPECT_NEAR(slave_.velocity(), -0.3, 1e-6);
}

TEST_F(MoteusOfNode3, AFaultIsClearedByStoppingOnceItsCauseHasGone) {
  DriveTroubles troubles;
  troubles.is_failing = true;
  slave_.setTroubles(troubles);
  EXPECT_EQ(run().fault, 33);
  EXPECT_EQ(after({.kind = MoteusCommand::Kind::kStop}).mode, 1);
  slave_.setTroubles({});
  EXPECT_EQ(ask({}).mode, 1);
  EXPECT_EQ(after({.kind = MoteusCommand::Kind::kStop}).mode, 0);
  EXPECT_EQ(ask({}).fault, 0);
}

TEST_F(MoteusOfNode3, HearsNobodyElse) {
  for (const std::uint32_t id : {0x8004u, 0x0003u, 0x8103u, 0x203u}) {
    CanFrame frame = moteusCommandFrame(3, {});
    frame.id = id;
    slave_.receive({frame, t_ns_}, t_ns_);
    EXPECT_TRUE(slave_.outbox().empty()) << id;
  }
  CanFrame cut = moteusCommandFrame(3, {.kind = MoteusCommand::Kind::kVelocity});
  cut.size = 5;
  slave_.receive({cut, t_ns_}, t_ns_);
  EXPECT_TRUE(slave_.outbox().empty());
}

/// Bytes of mjbots' docs/protocol/can.md and of fw/moteus_controller.cc, not of our encoder.
class MoteusBytes : public MoteusOfNode3 {
 protected:
  std::vector<int> hear(const std::vector<int>& bytes) {
    CanFrame frame = moteusCommandFrame(3, {});
    frame.size = 0;
    for (const int byte : bytes) frame.data[frame.size++] = static_cast<std::uint8_t>(byte);
    slave_.receive({frame, t_ns_}, t_ns_);
    std::vector<int> said;
    if (!slave_.outbox().empty()) {
      const CanFrame& reply = *slave_.outbox().begin();
      said.assign(reply.data.begin(), reply.data.begin() + reply.size);
    }
    slave_.outbox().clear();
    while (!said.empty() && said.back() == 0x50) said.pop_back();
    return said;
  }
  void enable() {
    run(0.1F);
    wait(4);
    run(0.1F);
    wait(1);
    ASSERT_NEAR(slave_.velocity(), -0.4, 1e-6);
  }
};

TEST_F(MoteusBytes, MoreThanThreeRegistersHaveTheirNumber) {
  EXPECT_EQ(hear({0x14, 0x04, 0x00, 0x11, 0x0F}), (std::vector<int>{0x31, 0x03, 1}))
      << "003 is none of what is here";
  slave_.setPosition(2.5);  // -0.5 turns
  EXPECT_EQ(hear({0x14, 0x03, 0x00}), (std::vector<int>{0x24, 0x03, 0x00, 0, 0, 0x78, 0xEC, 0, 0}));
}

TEST_F(MoteusBytes, TheMapOfRegistersIsReadAs32BitsOnly) {
  EXPECT_EQ(hear({0x19, 0x82, 0x02}), (std::vector<int>{0x29, 0x82, 0x02, 5, 0, 0, 0}));
  for (const int type : {0x11, 0x15, 0x1D})
    EXPECT_EQ(hear({type, 0x82, 0x02}), (std::vector<int>{0x31, 0x82, 0x02, 1})) << type;
}

TEST_F(MoteusBytes, WhatItDoesNotHaveIsAnError) {
  EXPECT_EQ(hear({0x11, 0x7E}), (std::vector<int>{0x31, 0x7E, 1}));
  EXPECT_EQ(hear({0x01, 0x7E, 0}), (std::vector<int>{0x30, 0x7E, 1}));
  EXPECT_EQ(hear({0x01, 0x0F, 0}), (std::vector<int>{0x30, 0x0F, 2}));
  EXPECT_EQ(hear({0x01, 0x00, 16}), (std::vector<int>{0x30, 0x00, 1})) << "there are 16 modes";
}

TEST_F(MoteusBytes, WithoutAModeAFrameCommandsNothing) {
  enable();
  for (int ms = 0; ms < 60; ++ms) {
    hear({0x0D, 0x21, 0, 0, 0, 0x41, 0x0D, 0x27, 0, 0, 0x80, 0x3F});  // 8 turns/s, 1 s
    wait(1);
  }
  EXPECT_EQ(slave_.mode(), 11) << "nor does it feed the watchdog";
}

TEST_F(MoteusBytes, WhatIsNotWrittenWithAModeIsZero) {
  enable();
  hear({0x01, 0x00, 10, 0x0D, 0x20, 0, 0, 0xC0, 0x7F});  // position NaN
  wait(1);
  EXPECT_EQ(slave_.velocity(), 0.0) << "the velocity of before";
  wait(98);
  EXPECT_EQ(slave_.mode(), 10);
  wait(2);
  EXPECT_EQ(slave_.mode(), 11) << "after 0.1 s, as it is configured";
}

TEST_F(MoteusBytes, GoesAtOnceToAPositionThatIsNotNan) {
  enable();
  slave_.setPosition(2.5);  // -0.5 turns
  hear({0x01, 0x00, 10});
  wait(1);
  EXPECT_LT(slave_.velocity(), -1.0) << "to 0";
}

TEST_F(MoteusBytes, AWatchdogOfNanIsNone) {
  enable();
  hear({0x01, 0x00, 10, 0x0E, 0x20, 0, 0, 0xC0, 0x7F, 0, 0, 0, 0, 0x0D, 0x27, 0, 0, 0xC0, 0x7F});
  wait(5000);
  EXPECT_EQ(slave_.mode(), 10);
}

TEST(MoteusSlave, ByItsRotorAloneItForgetsWholeTurns) {
  DriveConfig config;
  config.kind = DriveKind::kMoteus;
  config.node_id = 3;
  config.counts_per_unit = 1.0;
  config.home = MoteusHome::kRotor;
  MoteusSlave slave(config, 0.001);
  slave.setPowered(true, 0);
  slave.setPosition(5.7);
  const auto positionOf = [&slave] {
    slave.receive({moteusCommandFrame(3, {.asks_for_setup = true}), 0}, 0);
    const auto reply = decodeMoteusReply(*slave.outbox().begin(), 3);
    slave.outbox().clear();
    EXPECT_EQ(reply->home, 1);
    return reply->position;
  };
  EXPECT_NEAR(positionOf(), 5.7, 1e-6);
  slave.setPowered(false, 0);
  slave.setPowered(true, 0);
  EXPECT_NEAR(positionOf(), 0.7, 1e-6);
}

}  // namespace
}  // namespace tactus
