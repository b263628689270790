#include "tactus/plant/slave_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "plant/can_bytes.h"
#include "support/random.h"

/// One drive, node 5, without a bus: frames written by hand, in and out.
namespace tactus {
namespace {

using test::canFrame;
using test::number;

constexpr std::int64_t kMs = 1'000'000;

class DriveOfNode5 : public testing::Test {
 protected:
  DriveOfNode5() { drive_.setPowered(true, 0); }

  static DriveConfig config() {
    DriveConfig config;
    config.node_id = 5;
    config.counts_per_unit = 1000.0;
    config.offset = 0.5;
    config.sign = -1;
    return config;
  }

  static DriveTroubles failing() {
    DriveTroubles troubles;
    troubles.is_failing = true;
    return troubles;
  }

  void hear(const CanFrame& frame) { hearSince(t_ns_, frame); }
  void hearSince(std::int64_t sent_ns, const CanFrame& frame) {
    drive_.receive({frame, sent_ns}, t_ns_);
    collect();
  }
  void wait(std::int64_t ms) {
    const std::int64_t end_ns = t_ns_ + ms * kMs;
    while (drive_.nextEvent_ns() <= end_ns) {
      ASSERT_GE(drive_.nextEvent_ns(), t_ns_);
      t_ns_ = drive_.nextEvent_ns();
      drive_.update(t_ns_);
      collect();
    }
    t_ns_ = end_ns;
  }
  void collect() {
    for (const CanFrame& frame : drive_.outbox()) said_.push_back(frame);
    drive_.outbox().clear();
  }
  std::optional<CanFrame> lastSaid(std::uint32_t id) const {
    for (auto frame = said_.rbegin(); frame != said_.rend(); ++frame)
      if (frame->id == id) return *frame;
    return std::nullopt;
  }
  int timesSaid(std::uint32_t id) const {
    return static_cast<int>(
        std::count_if(said_.begin(), said_.end(), [&](const CanFrame& f) { return f.id == id; }));
  }

  void write(int index, int subindex, std::uint32_t value, int size) {
    hear(canFrame(0x605, {0x23 | (4 - size) << 2, index & 0xFF, index >> 8, subindex,
                          static_cast<int>(value & 0xFF), static_cast<int>(value >> 8 & 0xFF),
                          static_cast<int>(value >> 16 & 0xFF), static_cast<int>(value >> 24)}));
    ASSERT_TRUE(lastSaid(0x585));
    ASSERT_EQ(lastSaid(0x585)->data[0], 0x60)
        << std::hex << index << ' ' << number(*lastSaid(0x585), 4, 4);
  }
  /// Of a PDO, in the only state in which it may be.
  void change(int index, int subindex, std::uint32_t value, int size) {
    hear(canFrame(0, {128, 5}));
    write(index, subindex, value, size);
    hear(canFrame(0, {1, 5}));
  }
  void map(int communication, int mapping, std::uint32_t id, std::uint32_t first,
           std::uint32_t second) {
    write(communication, 1, 0x8000'0000U | id, 4);
    write(mapping, 0, 0, 1);
    write(mapping, 1, first, 4);
    write(mapping, 2, second, 4);
    write(mapping, 0, 2, 1);
    write(communication, 2, 1, 1);
    write(communication, 1, id, 4);
  }
  void configure() {
    wait(60);
    map(0x1400, 0x1600, 0x205, 0x6040'0010, 0x60FF'0020);
    map(0x1800, 0x1A00, 0x185, 0x6041'0010, 0x6064'0020);
    write(0x6060, 0, 9, 1);
    write(0x60C2, 1, 1, 1);
    write(0x6085, 0, 5000, 4);
    write(0x6007, 0, 3, 2);
    hear(canFrame(0, {1, 5}));
  }
  /// A period: RPDO, SYNC, and the drive moves.
  void cycle(int control_word, std::int32_t velocity_counts) {
    const auto v = static_cast<std::uint32_t>(velocity_counts);
    hear(canFrame(0x205,
                  {control_word, 0, static_cast<int>(v & 0xFF), static_cast<int>(v >> 8 & 0xFF),
                   static_cast<int>(v >> 16 & 0xFF), static_cast<int>(v >> 24)}));
    hear(canFrame(0x80, {}));
    drive_.move(0.001);
    collect();
    wait(1);
  }
  void enable() {
    for (const int word : {0x06, 0x07, 0x0F}) cycle(word, 0);
    ASSERT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  }
  int statusWord() const { return static_cast<int>(drive_.objects().get(0x6041)); }

  SlaveDrive drive_{config(), 0.001};
  std::int64_t t_ns_ = 0;
  std::vector<CanFrame> said_;
};

TEST_F(DriveOfNode5, BootsIntoPreOperationalAndSaysSoOnce) {
  hear(canFrame(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(said_.empty()) << "answers before it has booted";
  wait(1000);
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_EQ(said_[0], canFrame(0x705, {0}));
  EXPECT_EQ(drive_.nmtState(), NodeState::kPreOperational);
  EXPECT_EQ(statusWord() & 0x4F, 0x40);
}

TEST_F(DriveOfNode5, ObeysNmtForItselfAndForAll) {
  wait(60);
  hear(canFrame(0, {1, 4}));
  EXPECT_EQ(drive_.nmtState(), NodeState::kPreOperational) << "another node's";
  hear(canFrame(0, {1}));
  EXPECT_EQ(drive_.nmtState(), NodeState::kPreOperational) << "cut off";
  hear(canFrame(0, {1, 5}));
  EXPECT_EQ(drive_.nmtState(), NodeState::kOperational);
  hear(canFrame(0, {2, 0}));
  EXPECT_EQ(drive_.nmtState(), NodeState::kStopped);
  said_.clear();
  hear(canFrame(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(said_.empty()) << "no SDO while stopped";
  hear(canFrame(0, {128, 0}));
  EXPECT_EQ(drive_.nmtState(), NodeState::kPreOperational);
  hear(canFrame(0, {129, 5}));
  wait(60);
  EXPECT_EQ(timesSaid(0x705), 1) << "boots anew";
}

TEST_F(DriveOfNode5, ResetsGiveBackTheFactoryMapping) {
  configure();
  write(0x6085, 0, 777, 4);
  change(0x1400, 5, 60, 2);
  hear(canFrame(0, {130, 5}));
  wait(60);
  EXPECT_EQ(drive_.objects().get(0x1400, 5), 0u);
  EXPECT_EQ(drive_.objects().get(0x1600), 1u);
  EXPECT_EQ(drive_.objects().get(0x1400, 1), 0x205u);
  EXPECT_EQ(drive_.objects().get(0x6085), 777u) << "the device profile stays";
  hear(canFrame(0, {129, 5}));
  wait(60);
  EXPECT_NE(drive_.objects().get(0x6085), 777u);
  EXPECT_EQ(drive_.objects().get(0x6060), 0u);
}

TEST_F(DriveOfNode5, ProducesItsHeartbeat) {
  wait(60);
  write(0x1017, 0, 20, 2);
  said_.clear();
  wait(201);
  EXPECT_EQ(timesSaid(0x705), 10);
  EXPECT_EQ(*lastSaid(0x705), canFrame(0x705, {127}));
  hear(canFrame(0, {1, 0}));
  wait(20);
  EXPECT_EQ(*lastSaid(0x705), canFrame(0x705, {5}));
  write(0x1017, 0, 0, 2);
  said_.clear();
  wait(100);
  EXPECT_EQ(timesSaid(0x705), 0);
}

TEST_F(DriveOfNode5, LatchesSetpointsUntilSync) {
  configure();
  enable();
  hear(canFrame(0x205, {0x0F, 0, 0xE8, 0x03, 0, 0}));  // 1000 counts/s
  drive_.move(0.001);
  EXPECT_EQ(drive_.velocity(), 0.0);
  hear(canFrame(0x80, {}));
  drive_.move(0.001);
  EXPECT_EQ(drive_.velocity(), -1.0) << "sign -1, 1000 counts a rad";
  EXPECT_EQ(drive_.objects().getSigned(0x606C), 1000);
}

TEST_F(DriveOfNode5, ReportsPositionInCountsAtEverySync) {
  configure();
  said_.clear();
  drive_.setPosition(0.2);  // -1000 (0.2 - 0.5) = 300
  hear(canFrame(0x80, {}));
  ASSERT_EQ(timesSaid(0x185), 1);
  CanFrame feedback = *lastSaid(0x185);
  EXPECT_EQ(feedback.size, 6);
  EXPECT_EQ(number(feedback, 2, 4), 300u);
  EXPECT_EQ(number(feedback, 0, 2) & 0x4F, 0x40u);
  drive_.setPosition(0.7004);  // -200.4
  hear(canFrame(0x80, {}));
  feedback = *lastSaid(0x185);
  EXPECT_EQ(static_cast<std::int32_t>(number(feedback, 2, 4)), -200);
  hear(canFrame(0, {128, 5}));
  said_.clear();
  hear(canFrame(0x80, {}));
  EXPECT_EQ(timesSaid(0x185), 0) << "no PDO outside operational";
}

TEST_F(DriveOfNode5, AsDeliveredReportsItsStatusOnChangeOnly) {
  wait(60);
  hear(canFrame(0, {1, 5}));
  EXPECT_EQ(timesSaid(0x185), 1);
  EXPECT_EQ(lastSaid(0x185)->size, 2);
  for (int i = 0; i < 5; ++i) hear(canFrame(0x80, {}));
  EXPECT_EQ(timesSaid(0x185), 1);
  hear(canFrame(0x205, {0x06, 0}));
  EXPECT_EQ(timesSaid(0x185), 2);
  EXPECT_EQ(number(*lastSaid(0x185), 0, 2) & 0x6F, 0x21u);
}

TEST_F(DriveOfNode5, IgnoresShortSetpointsAndComplains) {
  configure();
  enable();
  cycle(0x0F, 700);
  hear(canFrame(0x205, {0x0F, 0, 0xE8, 0x03}));
  EXPECT_EQ(number(*lastSaid(0x85), 0, 2), 0x8210u);
  hear(canFrame(0x80, {}));
  drive_.move(0.001);
  EXPECT_EQ(drive_.velocity(), -0.7);
}

TEST_F(DriveOfNode5, AnInvalidPdoIsNeitherHeardNorSent) {
  configure();
  change(0x1400, 1, 0x8000'0205, 4);
  change(0x1800, 1, 0x8000'0185, 4);
  for (const std::uint32_t word : {0x06U, 0x07U, 0x0FU}) write(0x6040, 0, word, 2);
  ASSERT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  said_.clear();
  cycle(0x0F, 700);
  EXPECT_EQ(drive_.velocity(), 0.0);
  EXPECT_EQ(timesSaid(0x185), 0);
}

TEST_F(DriveOfNode5, ForgetsALatchedSetpointWhenItLeavesOperational) {
  configure();
  hear(canFrame(0x205, {0x06, 0, 0, 0, 0, 0}));
  hear(canFrame(0, {128, 5}));
  hear(canFrame(0, {1, 5}));
  hear(canFrame(0x80, {}));
  EXPECT_EQ(drive_.powerState(), PowerState::kSwitchOnDisabled);
}

TEST_F(DriveOfNode5, EnabledBySdoItWaitsForSyncAsLongAsAnyOther) {
  wait(1000);
  write(0x60C2, 1, 2, 1);  // 2 ms
  for (const std::uint32_t word : {0x06U, 0x07U, 0x0FU}) write(0x6040, 0, word, 2);
  ASSERT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  wait(9);
  EXPECT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  wait(1);
  EXPECT_EQ(drive_.powerState(), PowerState::kFaultReactionActive);
}

TEST_F(DriveOfNode5, FollowsOnlyInVelocityMode) {
  configure();
  write(0x6060, 0, 0, 1);
  enable();
  cycle(0x0F, 1000);
  EXPECT_EQ(drive_.velocity(), 0.0);
  write(0x6060, 0, 9, 1);
  EXPECT_EQ(drive_.objects().get(0x6061), 9u);
  cycle(0x0F, 1000);
  EXPECT_EQ(drive_.velocity(), -1.0);
}

TEST_F(DriveOfNode5, FollowsNoSetpointFasterThanItsLimit) {
  configure();
  write(0x607F, 0, 700, 4);
  enable();
  for (const int counts : {1000, -1000, 0x7FFF'FFFF, -0x7FFF'FFFF, 600}) {
    cycle(0x0F, counts);
    EXPECT_NEAR(drive_.velocity(), -0.001 * std::clamp(counts, -700, 700), 1e-12) << counts;
  }
}

TEST_F(DriveOfNode5, AddsAnOffsetThatItWasLeftWith) {
  configure();
  write(0x607F, 0, 700, 4);
  write(0x60B1, 0, 200, 4);
  enable();
  EXPECT_EQ(drive_.velocity(), -0.2) << "enabled with a setpoint of 0";
  for (const int counts : {300, -300, 600}) {
    cycle(0x0F, counts);
    EXPECT_NEAR(drive_.velocity(), -0.001 * std::min(counts + 200, 700), 1e-12) << counts;
  }
}

TEST_F(DriveOfNode5, StopsQuicklyByItsOwnRampWhateverTheSetpointSays) {
  configure();
  enable();
  cycle(0x0F, 1000);
  double last = drive_.velocity();
  int cycles = 0;
  while (drive_.powerState() != PowerState::kSwitchOnDisabled) {
    cycle(0x0B, 1000);
    EXPECT_NEAR(drive_.velocity() - last, 0.005, 1e-9) << "5000 counts/s^2";
    const bool is_stopping = drive_.powerState() == PowerState::kQuickStopActive;
    EXPECT_EQ(statusWord() & 0x6F, is_stopping ? 0x07 : 0x40);
    last = drive_.velocity();
    ASSERT_LT(++cycles, 202);
  }
  EXPECT_EQ(cycles, 200);
  EXPECT_EQ(drive_.velocity(), 0.0);
}

/// Nobody holds the joint then: the gear's friction alone slows it down.
TEST_F(DriveOfNode5, RollsOnWhenDisabled) {
  for (const int word : {0x00, 0x06, 0x07}) {
    hear(canFrame(0, {129, 5}));
    configure();
    enable();
    cycle(0x0F, -1000);
    cycle(word, -1000);
    EXPECT_NE(drive_.powerState(), PowerState::kOperationEnabled);
    EXPECT_NEAR(drive_.velocity(), 1.0 - 0.001, 1e-9);
    for (int i = 0; i < 998; ++i) cycle(word, -1000);
    EXPECT_NEAR(drive_.velocity(), 0.001, 1e-9);
    for (int i = 0; i < 2; ++i) cycle(word, -1000);
    EXPECT_EQ(drive_.velocity(), 0.0);
  }
}

/// As many drives leave the factory: a master that does not write 6007 has no watch.
TEST_F(DriveOfNode5, GoesOnWithoutTheMasterWhereNothingElseIsChosen) {
  configure();
  write(0x6007, 0, 0, 2);
  write(0x1016, 1, 0x007F'003C, 4);
  enable();
  hear(canFrame(0x77F, {5}));
  for (int i = 0; i < 100; ++i) cycle(0x0F, 500);
  EXPECT_GT(timesSaid(0x85), 0);
  EXPECT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  EXPECT_EQ(drive_.velocity(), -0.5);
}

TEST_F(DriveOfNode5, LetsNobodyChangeItsPdosWhileItIsOperational) {
  configure();
  for (const int index : {0x1400, 0x1600, 0x1800, 0x1A00, 0x1005}) {
    hear(canFrame(0x605, {0x2F, index & 0xFF, index >> 8, 0, 0, 0, 0, 0}));
    EXPECT_EQ(lastSaid(0x585)->data[0], 0x80) << std::hex << index;
  }
  hear(canFrame(0x605, {0x2F, 0x00, 0x16, 0, 0, 0, 0, 0}));
  EXPECT_EQ(number(*lastSaid(0x585), 4, 4), 0x0800'0022u);
  hear(canFrame(0, {128, 5}));
  map(0x1400, 0x1600, 0x205, 0x6040'0010, 0x60FF'0020);
}

TEST_F(DriveOfNode5, TakesNoSyncWithData) {
  configure();
  enable();
  const int before = timesSaid(0x185);
  for (int size = 1; size <= 8; ++size) {
    CanFrame sync = canFrame(0x80, {});
    sync.size = static_cast<std::uint8_t>(size);
    hear(sync);
    EXPECT_EQ(number(*lastSaid(0x85), 0, 2), 0x8240u);
  }
  EXPECT_EQ(timesSaid(0x185), before);
}

TEST_F(DriveOfNode5, MissesTheMastersHeartbeat) {
  configure();
  write(0x1016, 1, 0x007F'003C, 4);  // node 127, 60 ms
  enable();
  for (int i = 0; i < 200; ++i) cycle(0x0F, 500);
  EXPECT_EQ(drive_.powerState(), PowerState::kOperationEnabled) << "watches from the first one on";
  hear(canFrame(0x77E, {5}));
  hear(canFrame(0x77F, {5}));
  for (int i = 0; i < 59; ++i) cycle(0x0F, 500);
  EXPECT_EQ(timesSaid(0x85), 0);
  EXPECT_EQ(drive_.velocity(), -0.5);
  for (int i = 0; i < 2; ++i) cycle(0x0F, 500);
  ASSERT_EQ(timesSaid(0x85), 1);
  EXPECT_EQ(number(*lastSaid(0x85), 0, 2), 0x8130u);
  EXPECT_NE(lastSaid(0x85)->data[2], 0) << "error register";
  EXPECT_EQ(drive_.objects().get(0x603F), 0x8130u);
  EXPECT_EQ(drive_.nmtState(), NodeState::kPreOperational);
  EXPECT_EQ(statusWord() & 0x4F, 0x0F);
  for (int i = 0; i < 100; ++i) cycle(0x0F, 500);
  EXPECT_EQ(drive_.velocity(), 0.0);
  EXPECT_EQ(statusWord() & 0x4F, 0x08);
}

TEST_F(DriveOfNode5, HearsNoHeartbeatInOtherFrames) {
  configure();
  write(0x1016, 1, 0x007F'003C, 4);
  hear(canFrame(0x77F, {5, 0}));
  wait(1000);
  EXPECT_EQ(timesSaid(0x85), 0) << "armed by a frame that is no heartbeat";
  hear(canFrame(0x77F, {5}));
  wait(59);
  hear(canFrame(0x77F, {5, 0}));
  wait(2);
  EXPECT_EQ(timesSaid(0x85), 1) << "kept quiet by a frame that is no heartbeat";
}

TEST_F(DriveOfNode5, StopsListeningWhenItIsTold) {
  configure();
  write(0x1016, 1, 0x007F'003C, 4);
  hear(canFrame(0x77F, {5}));
  write(0x1016, 1, 0, 4);
  wait(1000);
  EXPECT_EQ(timesSaid(0x85), 0);
}

TEST_F(DriveOfNode5, MissesSync) {
  configure();
  enable();
  cycle(0x0F, 500);
  wait(3);
  EXPECT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  wait(2);
  EXPECT_EQ(number(*lastSaid(0x85), 0, 2), 0x8700u);
  EXPECT_EQ(drive_.nmtState(), NodeState::kOperational);
  EXPECT_EQ(drive_.powerState(), PowerState::kFaultReactionActive);
}

TEST_F(DriveOfNode5, MissesSetpointsWhileSyncAndHeartbeatGoOn) {
  configure();
  change(0x1400, 5, 20, 2);
  enable();
  for (int i = 0; i < 100; ++i) cycle(0x0F, 500);
  ASSERT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
  hear(canFrame(0x205, {0x0F, 0, 0, 0}));  // too short: the drive has got none
  said_.clear();
  for (int i = 0; i < 18; ++i) {
    hear(canFrame(0x80, {}));
    wait(1);
  }
  EXPECT_EQ(timesSaid(0x85), 0);
  EXPECT_EQ(drive_.velocity(), -0.5);
  hear(canFrame(0x80, {}));
  wait(1);
  ASSERT_EQ(timesSaid(0x85), 1);
  EXPECT_EQ(number(*lastSaid(0x85), 0, 2), 0x8250u);
  EXPECT_EQ(drive_.objects().get(0x603F), 0x8250u);
  EXPECT_EQ(drive_.powerState(), PowerState::kFaultReactionActive);
  EXPECT_EQ(drive_.nmtState(), NodeState::kOperational);
  for (int i = 0; i < 101; ++i) drive_.move(0.001);
  EXPECT_EQ(drive_.velocity(), 0.0);
}

TEST_F(DriveOfNode5, HasNoDeadlineForSetpointsUnlessItIsToldOne) {
  configure();
  change(0x1400, 5, 20, 2);
  for (int i = 0; i < 100; ++i) {
    hear(canFrame(0x80, {}));
    wait(1);
  }
  EXPECT_EQ(timesSaid(0x85), 0) << "it is disabled";
  change(0x1400, 5, 0, 2);
  enable();
  for (int i = 0; i < 100; ++i) {
    hear(canFrame(0x80, {}));
    wait(1);
  }
  EXPECT_EQ(timesSaid(0x85), 0);
  EXPECT_EQ(drive_.powerState(), PowerState::kOperationEnabled);
}

TEST_F(DriveOfNode5, EnabledBySdoItWaitsForSetpointsAsLongAsAnyOther) {
  configure();
  wait(1000);
  change(0x1400, 5, 20, 2);
  for (const std::uint32_t word : {0x06U, 0x07U, 0x0FU}) write(0x6040, 0, word, 2);
  const auto stays = [&](int ms) {
    for (int i = 0; i < ms; ++i) {
      hear(canFrame(0x80, {}));
      wait(1);
    }
    return drive_.powerState() == PowerState::kOperationEnabled;
  };
  EXPECT_TRUE(stays(19));
  EXPECT_FALSE(stays(1));
}

TEST_F(DriveOfNode5, IsNoFaultToBeDisabledWithoutSync) {
  configure();
  wait(1000);
  EXPECT_EQ(timesSaid(0x85), 0);
}

TEST_F(DriveOfNode5, ForgivesAFaultOnceItsCauseIsGone) {
  configure();
  enable();
  cycle(0x0F, 100);
  drive_.setTroubles(failing());
  collect();
  EXPECT_EQ(number(*lastSaid(0x85), 0, 2), 0x2310u);
  for (int i = 0; i < 20; ++i) cycle(0x0F, 100);
  EXPECT_EQ(statusWord() & 0x4F, 0x08);
  cycle(0x80, 0);
  EXPECT_EQ(statusWord() & 0x4F, 0x08) << "still failing";
  drive_.setTroubles({});
  cycle(0x80, 0);
  EXPECT_EQ(statusWord() & 0x4F, 0x08) << "no edge";
  cycle(0x00, 0);
  cycle(0x80, 0);
  EXPECT_EQ(statusWord() & 0x4F, 0x40);
  EXPECT_EQ(*lastSaid(0x85), canFrame(0x85, {0, 0, 0, 0, 0, 0, 0, 0})) << "error reset";
  enable();
}

TEST_F(DriveOfNode5, LeavingOperationalWhileEnabledIsAFault) {
  for (const int command : {2, 128, 130}) {
    hear(canFrame(0, {129, 5}));
    configure();
    enable();
    cycle(0x0F, 300);
    hear(canFrame(0, {command, 5}));
    EXPECT_EQ(drive_.powerState(), PowerState::kFaultReactionActive) << command;
    for (int i = 0; i < 61; ++i) cycle(0x0F, 300);
    EXPECT_EQ(drive_.velocity(), 0.0);
    EXPECT_EQ(drive_.powerState(), PowerState::kFault);
  }
}

TEST_F(DriveOfNode5, WithoutPowerItIsSilentAndRollsToRest) {
  configure();
  write(0x1017, 0, 10, 2);
  enable();
  cycle(0x0F, 100);
  said_.clear();
  drive_.setPowered(false, t_ns_);
  for (int i = 0; i < 101; ++i) cycle(0x0F, 100);
  EXPECT_TRUE(said_.empty());
  EXPECT_EQ(drive_.velocity(), 0.0);
  drive_.setPosition(0.4);
  drive_.setPowered(true, t_ns_);
  wait(60);
  EXPECT_EQ(timesSaid(0x705), 1);
  for (int i = 0; i < 10; ++i) cycle(0x0F, 100);
  EXPECT_EQ(drive_.velocity(), 0.0) << "not without being set up anew";
  EXPECT_EQ(drive_.objects().getSigned(0x6064), 100);
}

TEST_F(DriveOfNode5, ALastingFaultOutlivesAPowerCut) {
  configure();
  drive_.setTroubles(failing());
  drive_.setPowered(false, t_ns_);
  drive_.setPowered(true, t_ns_);
  said_.clear();
  wait(60);
  drive_.move(0.001);
  EXPECT_EQ(statusWord() & 0x4F, 0x08);
  ASSERT_EQ(said_.size(), 2u);
  EXPECT_EQ(said_[0], canFrame(0x705, {0}));
  EXPECT_EQ(number(said_[1], 0, 2), 0x2310u);
}

TEST_F(DriveOfNode5, CountsStaleSetpointsOnlyWhereTheyMoveIt) {
  configure();
  const CanFrame setpoint = canFrame(0x205, {0x0F, 0, 100, 0, 0, 0});
  hearSince(t_ns_ - 10 * kMs, setpoint);
  hear(canFrame(0x80, {}));
  EXPECT_EQ(drive_.staleSetpoints(), 0u) << "not enabled";
  enable();
  hearSince(t_ns_ - 2 * kMs, setpoint);
  hear(canFrame(0x80, {}));
  EXPECT_EQ(drive_.staleSetpoints(), 0u) << "two periods are allowed";
  hearSince(t_ns_ - 2 * kMs - 1, setpoint);
  hear(canFrame(0x80, {}));
  EXPECT_EQ(drive_.staleSetpoints(), 1u);
  hear(canFrame(0x80, {}));
  EXPECT_EQ(drive_.staleSetpoints(), 1u) << "each counts once";
}

TEST_F(DriveOfNode5, NoFrameMovesItButAnEnabledDrivesSetpoint) {
  test::Random random(831);
  configure();
  for (int i = 0; i < 100000; ++i) {
    constexpr std::array<int, 9> kIds = {0x000, 0x080, 0x205, 0x605, 0x585, 0x77F, 0x185, 0x85, 1};
    CanFrame frame = canFrame(static_cast<std::uint32_t>(kIds[random.index(9)]), {});
    frame.size = static_cast<std::uint8_t>(random.index(9));
    for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random.index(256));
    frame.extended = random.chance(0.1);
    if (random.chance(0.1)) frame.kind = FrameKind::kRemote;
    hear(frame);
    const double before = drive_.velocity();
    drive_.move(0.001);
    const bool may_move = drive_.powerState() == PowerState::kOperationEnabled;
    ASSERT_TRUE(may_move || std::abs(drive_.velocity()) <= std::abs(before));
    said_.clear();
    if (i % 10 == 0) wait(1);
  }
}

TEST(DriveWithADataSheet, IsTheProductThatItNames) {
  DriveConfig config;
  config.vendor_id = 0x5A65726F;
  SlaveDrive drive(config, 0.001);
  for (int power = 0; power < 2; ++power) {
    drive.setPowered(true, 0);
    EXPECT_EQ(drive.objects().get(0x1018, 1), 0x5A65726Fu);
    EXPECT_EQ(drive.objects().get(0x1018, 2), 1u) << "as from a factory";
    drive.setPowered(false, 0);
  }
}

}  // namespace
}  // namespace tactus
