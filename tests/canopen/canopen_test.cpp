#include "tactus/canopen/canopen.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/scripted_drive.h"

namespace tactus {
namespace {

using test::rawFrame;

TEST(Canopen, SendsTheBytesOfTheStandard) {
  EXPECT_EQ(syncFrame(), rawFrame(0x080, {}));
  EXPECT_EQ(nmtFrame({NmtCommand::kStart, 5}), rawFrame(0x000, {0x01, 5}));
  EXPECT_EQ(nmtFrame({NmtCommand::kStop, 0}), rawFrame(0x000, {0x02, 0}));
  EXPECT_EQ(nmtFrame({NmtCommand::kEnterPreOperational, 127}), rawFrame(0x000, {0x80, 127}));
  EXPECT_EQ(nmtFrame({NmtCommand::kResetNode, 1}), rawFrame(0x000, {0x81, 1}));
  EXPECT_EQ(nmtFrame({NmtCommand::kResetCommunication, 1}), rawFrame(0x000, {0x82, 1}));
  EXPECT_EQ(heartbeatFrame(127, NmtState::kOperational), rawFrame(0x77F, {0x05}));
  EXPECT_EQ(heartbeatFrame(1, NmtState::kBootUp), rawFrame(0x701, {0x00}));
  EXPECT_EQ(emergencyFrame(3, {0x8130, 0x11}), rawFrame(0x083, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
}

TEST(Canopen, KnowsFourStatesOfAHeartbeatAndNoOther) {
  for (int value = 0; value < 256; ++value) {
    const auto state = decodeHeartbeat(rawFrame(0x70A, {value}), 10);
    const bool is_known = value == 0 || value == 4 || value == 5 || value == 127;
    ASSERT_EQ(state.has_value(), is_known) << value;
    if (state) {
      EXPECT_EQ(static_cast<int>(*state), value);
    }
  }
}

TEST(Canopen, KnowsFiveCommandsAndTheirNodes) {
  for (int command = 0; command < 256; ++command) {
    for (int node : {0, 1, 127, 128, 255}) {
      const auto message = decodeNmt(rawFrame(0, {command, node}));
      const bool is_command =
          command == 1 || command == 2 || command == 128 || command == 129 || command == 130;
      ASSERT_EQ(message.has_value(), is_command && node < 128) << command << " " << node;
      if (message) {
        EXPECT_EQ(nmtFrame(*message), rawFrame(0, {command, node}));
      }
    }
  }
}

TEST(Canopen, ReadsEmergencies) {
  const CanFrame frame = rawFrame(0x0FF, {0x20, 0x43, 0x09, 1, 2, 3, 4, 5});
  EXPECT_EQ(decodeEmergency(frame, 127), (Emergency{0x4320, 0x09}));
  EXPECT_EQ(decodeEmergency(frame, 126), std::nullopt);
}

TEST(Canopen, TakesNothingOfWrongIdSizeOrKind) {
  for (int size = 0; size <= 8; ++size) {
    CanFrame frame = rawFrame(0, std::vector<int>(size, 5));
    frame.data[0] = 1;
    EXPECT_EQ(decodeNmt(frame).has_value(), size == 2);
    frame.id = 0x085;
    EXPECT_EQ(decodeEmergency(frame, 5).has_value(), size == 8);
    frame.id = 0x705;
    frame.data[0] = 5;
    EXPECT_EQ(decodeHeartbeat(frame, 5).has_value(), size == 1);
    EXPECT_FALSE(decodeHeartbeat(frame, 6).has_value());
  }
  CanFrame heartbeat = heartbeatFrame(5, NmtState::kOperational);
  heartbeat.extended = true;
  EXPECT_FALSE(decodeHeartbeat(heartbeat, 5));
  heartbeat.extended = false;
  for (FrameKind kind : {FrameKind::kRemote, FrameKind::kError}) {
    heartbeat.kind = kind;
    EXPECT_FALSE(decodeHeartbeat(heartbeat, 5));
  }
}

TEST(Canopen, WritesNumbersLittleEndianAndNothingBeside) {
  CanFrame frame = rawFrame(0, {0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA});
  writeLittleEndian(frame, 2, 3, 0x99123456);
  EXPECT_EQ(frame, rawFrame(0, {0xAA, 0xAA, 0x56, 0x34, 0x12, 0xAA, 0xAA, 0xAA}));
  EXPECT_EQ(readLittleEndian(frame, 2, 3), 0x123456u);
  EXPECT_EQ(readLittleEndian(frame, 4, 4), 0xAAAAAA12u);
  test::Random random(401);
  for (int i = 0; i < 1000; ++i) {
    const int size = random.integer(1, 4);
    const int offset = random.integer(0, 8 - size);
    const auto value = static_cast<std::uint32_t>(random.index(1 << 30)) << random.index(3);
    writeLittleEndian(frame, offset, size, value);
    EXPECT_EQ(readLittleEndian(frame, offset, size), value & (0xFFFFFFFFu >> (32 - 8 * size)));
  }
}

}  // namespace
}  // namespace tactus
