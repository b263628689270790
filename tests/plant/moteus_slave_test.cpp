#include "tactus/plant/moteus_slave.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

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
  EXPECT_EQ(run().mode, 2);
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
  EXPECT_EQ(ask({.kind = MoteusCommand::Kind::kStop}).mode, 0);
  EXPECT_EQ(run().mode, 2);
}

TEST_F(MoteusOfNode3, AFaultIsClearedByStoppingOnceItsCauseHasGone) {
  DriveTroubles troubles;
  troubles.is_failing = true;
  slave_.setTroubles(troubles);
  EXPECT_EQ(run().fault, 33);
  EXPECT_EQ(ask({.kind = MoteusCommand::Kind::kStop}).mode, 1);
  slave_.setTroubles({});
  EXPECT_EQ(ask({}).mode, 1);
  EXPECT_EQ(ask({.kind = MoteusCommand::Kind::kStop}).mode, 0);
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

}  // namespace
}  // namespace tactus
