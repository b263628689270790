#include "tactus/io/kernel_frame.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace tactus {
namespace {

CanFrame randomFrame(std::mt19937& random, bool is_fd) {
  CanFrame frame;
  frame.is_fd = is_fd;
  frame.extended = random() % 2 == 0;
  frame.id = static_cast<std::uint32_t>(random()) & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = static_cast<std::uint8_t>(is_fd ? fdSize(static_cast<int>(random() % 65))
                                               : static_cast<int>(random() % 9));
  for (int i = 0; i < frame.size; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
  return frame;
}

TEST(KernelFrame, GoesThereAndBackOfEitherKind) {
  std::mt19937 random(11);
  for (int run = 0; run < 2000; ++run) {
    const CanFrame frame = randomFrame(random, run % 2 == 0);
    canfd_frame room;
    std::memset(&room, 0xA5, sizeof(room));
    const std::size_t bytes = putKernelFrame(frame, room);
    ASSERT_EQ(bytes, frame.is_fd ? CANFD_MTU : CAN_MTU);
    EXPECT_EQ(room.len, frame.size);
    EXPECT_EQ(room.can_id, frame.id | (frame.extended ? CAN_EFF_FLAG : 0U));
    if (frame.is_fd) {
      EXPECT_NE(room.flags & CANFD_BRS, 0);
    }
    EXPECT_EQ(takeKernelFrame(room, bytes), frame);
  }
}

TEST(KernelFrame, IsFilledUpToASizeThatThereIs) {
  CanFrame frame;
  frame.is_fd = true;
  frame.size = 18;
  frame.data.fill(0xEE);
  const canfd_frame raw = toKernelFd(frame);
  EXPECT_EQ(raw.len, 20);
  EXPECT_EQ(raw.data[17], 0xEE);
  EXPECT_EQ(raw.data[18], 0);
}

TEST(KernelFrame, CutsSizesThatThereAreNot) {
  canfd_frame room{};
  room.len = 255;
  EXPECT_EQ(takeKernelFrame(room, CANFD_MTU).size, 64);
  EXPECT_EQ(takeKernelFrame(room, CAN_MTU).size, 8);
  CanFrame frame;
  frame.size = 64;
  EXPECT_EQ(toKernel(frame).len, 8);
  frame.size = 255;
  EXPECT_EQ(toKernelFd(frame).len, 64);
}

}  // namespace
}  // namespace tactus
