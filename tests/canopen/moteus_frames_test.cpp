#include "tactus/canopen/moteus_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace tactus {
namespace {

std::string hexOf(const CanFrame& frame) {
  std::string text;
  for (int i = 0; i < frame.size; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[frame.data[i] >> 4];
    text += kDigits[frame.data[i] & 15];
  }
  return text;
}

CanFrame replyOf(int node_id, const std::string& hex) {
  CanFrame frame;
  frame.id = moteusReplyId(node_id);
  frame.is_fd = true;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    frame.data[frame.size++] = static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return frame;
}

using MoteusAsk = MoteusCommand::Kind;

TEST(MoteusFrames, AreThoseOfItsReference) {
  // Before their padding these are the bytes that make_position(position=nan, velocity=2,
  // watchdog_timeout=0.5), make_stop() and make_query() of PyPI's moteus 1.1.1 make, asked for the
  // same registers; it reads the replies below as we do.
  const CanFrame velocity =
      moteusCommandFrame(5, {.kind = MoteusAsk::kVelocity, .velocity = 2.0F, .watchdog_s = 0.5F});
  EXPECT_EQ(velocity.id, 0x8005u);
  EXPECT_TRUE(velocity.extended && velocity.is_fd);
  EXPECT_EQ(hexOf(velocity), "01000a0e200000c07f000000400d270000003f11001e01110f50505050505050");
  EXPECT_EQ(hexOf(moteusCommandFrame(5, {.kind = MoteusAsk::kZeroVelocity})),
            "01000c11001e01110f505050");
  EXPECT_EQ(hexOf(moteusCommandFrame(5, {.kind = MoteusAsk::kStop})), "01000011001e01110f505050");
  EXPECT_EQ(hexOf(moteusCommandFrame(5, {.asks_for_setup = true})), "11001e01110f110c19820250");
  EXPECT_EQ(hexOf(moteusCommandFrame(5, {})), "11001e01110f");
}

TEST(MoteusFrames, FitIntoWhatTheBusIsReckonedWith) {
  for (const auto kind :
       {MoteusAsk::kQuery, MoteusAsk::kStop, MoteusAsk::kZeroVelocity, MoteusAsk::kVelocity}) {
    const CanFrame frame = moteusCommandFrame(127, {.kind = kind, .asks_for_setup = true});
    EXPECT_EQ(frame.size, fdSize(frame.size));
    EXPECT_LE(frame.size, kMoteusCommandBytes);
  }
}

TEST(MoteusFrames, AReplyIsReadInAnyType) {
  // The example of docs/protocol/can.md: four int16 from mode on, then voltage, temperature, fault.
  const auto reply = decodeMoteusReply(replyOf(1, "2404000a005000000170ff230d181400"), 1);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->mode, 10);
  EXPECT_NEAR(reply->position * 360.0, 2.88, 1e-9);
  EXPECT_NEAR(reply->velocity * 360.0, 23.04, 1e-9);
  EXPECT_EQ(reply->fault, 0);
  EXPECT_FALSE(reply->map);
  const auto floats =
      decodeMoteusReply(replyOf(3, "21000b2e010000803f000020c0210f2129820205000000505050"), 3);
  ASSERT_TRUE(floats);
  EXPECT_EQ(*floats, (MoteusReply{11, 1.0, -2.5, 33, 5, std::nullopt}));
  const auto unknown = decodeMoteusReply(replyOf(3, "2d00000020412a0100000080ffffff7f210f00"), 3);
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->mode, 10);
  EXPECT_TRUE(std::isnan(unknown->position)) << "the most negative integer";
  EXPECT_NEAR(unknown->velocity, 21474.83647, 1e-9);
}

/// 31 82 02 01: a controller that cannot read register 0x102 so; the rest counts all the same.
TEST(MoteusFrames, ARegisterThatCouldNotBeReadIsLeftOut) {
  const auto reply = decodeMoteusReply(replyOf(3, "21000a2e010000803f000020c0210f0031820201"), 3);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->mode, 10);
  EXPECT_FALSE(reply->map);
  EXPECT_TRUE(decodeMoteusReply(replyOf(3, "21000a2e010000803f000020c0210f00300f02"), 3));
  EXPECT_FALSE(decodeMoteusReply(replyOf(3, "21000a2e010000803f000020c0210f003182"), 3));
}

TEST(MoteusFrames, NegativeNumbersHaveTheirSignInAnyType) {
  struct Negative {
    const char* reply;
    double position, velocity;
  };
  constexpr Negative kNegatives[] = {
      {"20040003b0f000210f00", -0.8, -1.6},                               // int8
      {"2404000300e0fcb0fc0000210f00", -0.08, -0.212},                    // int16
      {"280400030000000083ffff9061ffff00000000210f00", -0.32, -0.4056}};  // int32
  for (const Negative& negative : kNegatives) {
    const auto read = decodeMoteusReply(replyOf(1, negative.reply), 1);
    ASSERT_TRUE(read) << negative.reply;
    EXPECT_EQ(read->mode, 3) << negative.reply;
    EXPECT_NEAR(read->position, negative.position, 1e-9) << negative.reply;
    EXPECT_NEAR(read->velocity, negative.velocity, 1e-9) << negative.reply;
  }
}

/// A float where a register holds whole numbers: far beyond them it is no mode.
TEST(MoteusFrames, ModesThatAreNoNumberAreNone) {
  for (const char* const mode : {"000020d0", "00002050", "0000c07f"}) {  // -1e10, 1e10, NaN
    const std::string hex = "2d00" + std::string(mode) + "2a0100000080ffffff7f210f00";
    const auto reply = decodeMoteusReply(replyOf(3, hex), 3);
    ASSERT_TRUE(reply) << mode;
    EXPECT_EQ(reply->mode, -1) << mode;
  }
}

TEST(MoteusFrames, NothingElseIsAReply) {
  const std::string good = "2100002e010000000000000000210f00";
  EXPECT_TRUE(decodeMoteusReply(replyOf(2, good), 2));
  EXPECT_FALSE(decodeMoteusReply(replyOf(2, good), 3)) << "another node's";
  for (const char* const bad :
       {"", "2100", "2100002e0100000000000000", "21000021", "2100002e010000000000000000",
        "2e010000000000000000210f00", "2100002e010000000000000000210f0030", "11001e01110f", "20ff",
        "20ffffffffffff", "2100002e010000000000000000210f00ff",
        // without position, without velocity, a subframe of another kind, numbers of 36 bits
        "2100002d0200000000210f00", "2100002d0100000000210f00",
        "2100002e010000000000000000210f00320000", "2100002e010000000000000000210f0020808080808000",
        "2100002e010000000000000000210f002080808080800000"})
    EXPECT_FALSE(decodeMoteusReply(replyOf(2, bad), 2)) << bad;
  CanFrame frame = replyOf(2, good);
  frame.is_fd = false;
  EXPECT_FALSE(decodeMoteusReply(frame, 2));
  frame = replyOf(2, good);
  while (frame.size < 64) frame.data[frame.size++] = 0x50;  // padding
  EXPECT_TRUE(decodeMoteusReply(frame, 2)) << "the longest";
  frame.size = 65;
  EXPECT_FALSE(decodeMoteusReply(frame, 2)) << "longer than any";
  frame = replyOf(2, good);
  frame.kind = FrameKind::kRemote;
  EXPECT_FALSE(decodeMoteusReply(frame, 2));
}

/// Whatever bytes come: no reply, or one that is whole.
TEST(MoteusFrames, AnyBytesAreReadOrRefused) {
  std::mt19937 random(5);
  int read = 0;
  for (int run = 0; run < 20000; ++run) {
    CanFrame frame = replyOf(9, "2100002e010000000000000000210f002982020500000050");
    for (int change = 0; change < 1 + run % 3; ++change)
      frame.data[random() % 24] = static_cast<std::uint8_t>(random());
    frame.size = static_cast<std::uint8_t>(random() % 4 == 0 ? random() % 65 : 24);
    if (const auto reply = decodeMoteusReply(frame, 9)) {
      ++read;
      EXPECT_GE(reply->mode, -128);
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_LT(read, 19000);
}

}  // namespace
}  // namespace tactus
