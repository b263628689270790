#include "tactus/supervisor/enable_wait.h"

#include <gtest/gtest.h>

namespace tactus {
namespace {

GpioInputs linesWith(bool enable, bool is_valid = true) {
  GpioInputs lines;
  lines.enable = enable;
  lines.is_valid = is_valid;
  return lines;
}

TEST(EnableWait, CountsTheLineOnceItWasOff) {
  EnableWait wait(3);
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(wait.update(linesWith(true)).enable);
  EXPECT_FALSE(wait.update(linesWith(false, false)).enable);
  EXPECT_FALSE(wait.update(linesWith(true)).enable) << "a chip that fails shows nothing";
  for (const auto& flicker : {linesWith(true), linesWith(false, false)}) {
    for (int i = 0; i < 2; ++i) EXPECT_FALSE(wait.update(linesWith(false)).enable);
    EXPECT_FALSE(wait.update(flicker).enable);
    EXPECT_FALSE(wait.update(linesWith(true)).enable) << "off for a moment alone";
  }
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(wait.update(linesWith(false)).enable);
  EXPECT_TRUE(wait.update(linesWith(true)).enable);
  EXPECT_FALSE(wait.update(linesWith(false)).enable);
  EXPECT_TRUE(wait.update(linesWith(true)).enable);
}

TEST(EnableWait, TellsOfALineThatHasToGoOff) {
  EnableWait wait(2), none(0);
  EXPECT_TRUE(wait.update(linesWith(true)).must_go_off);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(wait.update(linesWith(false)).must_go_off);
  EXPECT_FALSE(wait.update(linesWith(true)).must_go_off);
  EXPECT_FALSE(none.update(linesWith(true)).must_go_off);
}

TEST(EnableWait, ChangesNothingElse) {
  EnableWait waits(3), none(0);
  GpioInputs pressed = linesWith(true);
  pressed.emergency_stop = true;
  EXPECT_TRUE(waits.update(pressed).emergency_stop);
  EXPECT_FALSE(waits.update(linesWith(true, false)).is_valid);
  EXPECT_TRUE(none.update(linesWith(true)).enable);
}

}  // namespace
}  // namespace tactus
