#include "tactus/canopen/pdo.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/scripted_drive.h"

namespace tactus {
namespace {

using test::rawFrame;

TEST(Pdo, PacksControlWordAndVelocity) {
  EXPECT_EQ(commandFrame(3, {0x000F, 0x12345678}),
            rawFrame(0x203, {0x0F, 0x00, 0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(commandFrame(127, {0x8002, -2}), rawFrame(0x27F, {0x02, 0x80, 0xFE, 0xFF, 0xFF, 0xFF}));
}

TEST(Pdo, UnpacksStatusWordAndPosition) {
  EXPECT_EQ(decodeFeedback(rawFrame(0x181, {0x37, 0x16, 0x00, 0x00, 0x00, 0x80}), 1),
            (DriveFeedback{0x1637, -2147483647 - 1}));
  EXPECT_EQ(decodeFeedback(rawFrame(0x1FF, {0x08, 0x00, 0xFF, 0xFF, 0xFF, 0x7F}), 127),
            (DriveFeedback{0x0008, 2147483647}));
}

TEST(Pdo, TakesNothingOfWrongSizeIdOrKind) {
  for (int size = 0; size <= 8; ++size)
    EXPECT_EQ(decodeFeedback(rawFrame(0x185, std::vector<int>(size, 1)), 5).has_value(), size == 6);
  CanFrame frame = rawFrame(0x185, {1, 2, 3, 4, 5, 6});
  EXPECT_FALSE(decodeFeedback(frame, 6));
  frame.extended = true;
  EXPECT_FALSE(decodeFeedback(frame, 5));
  frame.extended = false;
  frame.is_fd = true;
  EXPECT_FALSE(decodeFeedback(frame, 5));
  frame.is_fd = false;
  frame.kind = FrameKind::kRemote;
  EXPECT_FALSE(decodeFeedback(frame, 5));
}

}  // namespace
}  // namespace tactus
