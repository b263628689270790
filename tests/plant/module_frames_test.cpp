#include "tactus/plant/module_frames.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tactus {
namespace {

/// Byte by byte, as the contract of the frames has it.
std::int32_t channel(const CanFrame& frame, int first) {
  const int low = frame.data[first], middle = frame.data[first + 1], high = frame.data[first + 2];
  return low + 256 * middle + 65536 * (high < 128 ? high : high - 256);
}

TEST(ModuleFrames, LayOutOneSampleByHand) {
  const auto frames =
      moduleFrames(0x100, 0xA7, {1, -1, 256, -256, 65536, -65536, 8388606, -2}, false);
  const std::array<decltype(CanFrame::data), 4> expected = {
      {{0xA7, 0, 0x01, 0x00, 0x00, 0xFF, 0xFF, 0xFF},
       {0xA7, 0, 0x00, 0x01, 0x00, 0x00, 0xFF, 0xFF},
       {0xA7, 0, 0x00, 0x00, 0x01, 0x00, 0x00, 0xFF},
       {0xA7, 0, 0xFE, 0xFF, 0x7F, 0xFE, 0xFF, 0xFF}}};
  for (unsigned k = 0; k < 4; ++k) {
    EXPECT_EQ(frames[k].id, 0x100u + k);
    EXPECT_EQ(frames[k].size, 8);
    EXPECT_EQ(frames[k].kind, FrameKind::kData);
    EXPECT_FALSE(frames[k].extended);
    EXPECT_EQ(frames[k].data, expected[k]) << k;
  }
}

TEST(ModuleFrames, KeepEveryCount) {
  test::Random random(811);
  for (int i = 0; i < 2000; ++i) {
    ModuleCounts counts;
    for (std::int32_t& count : counts) count = random.integer(-8388606, 8388606);
    const auto frames = moduleFrames(0x120, static_cast<std::uint8_t>(i), counts, false);
    for (unsigned k = 0; k < 4; ++k) {
      ASSERT_EQ(channel(frames[k], 2), counts[2 * k]);
      ASSERT_EQ(channel(frames[k], 5), counts[2 * k + 1]);
      ASSERT_EQ(frames[k].data[0], i % 256);
      ASSERT_EQ(frames[k].data[1], 0);
    }
  }
}

TEST(ModuleFrames, SaturateAndSayItInEveryFrame) {
  for (const std::int32_t beyond :
       {8388607, 8388608, 2147483647, -8388607, -8388608, -2147483647}) {
    ModuleCounts counts{};
    counts[5] = beyond;
    const auto frames = moduleFrames(0x100, 0, counts, false);
    EXPECT_EQ(channel(frames[2], 5), beyond > 0 ? 8388607 : -8388607);
    for (const CanFrame& frame : frames) EXPECT_EQ(frame.data[1], 1);
  }
}

TEST(ModuleFrames, SayThatTheCableIsBroken) {
  for (const CanFrame& frame : moduleFrames(0x100, 0, {}, true)) EXPECT_EQ(frame.data[1], 2);
}

}  // namespace
}  // namespace tactus
