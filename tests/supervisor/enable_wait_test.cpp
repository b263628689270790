#include "tactus/supervisor/enable_wait.h"

#include <gtest/gtest.h>

namespace tactus {
namespace {

GpioInputs linesWith(bool enable, bool is_valid = true) {
  GpioInputs lines;
  lines.enable = enable;
  lines.is_enable_off = !enable;
  lines.is_valid = is_valid;
  return lines;
}

/// As of a daemon that runs.
EnableWait runningWait(int off_cycles) {
  EnableWait wait(off_cycles);
  for (int i = 0; i < off_cycles; ++i) wait.update(linesWith(false));
  return wait;
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
  for (int i = 0; i < 300; ++i) EXPECT_FALSE(wait.update(linesWith(false)).enable);
  EXPECT_TRUE(wait.update(linesWith(true)).enable);
}

/// Off and on lets a stopped arm go on; so does no contact that chatters.
TEST(EnableWait, TakesALineThatFlickersForOff) {
  EnableWait wait = runningWait(3);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(wait.update(linesWith(true)).enable);
  for (int off = 1; off <= 2; ++off) {
    for (int i = 0; i < off; ++i) EXPECT_FALSE(wait.update(linesWith(false)).enable);
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(wait.update(linesWith(true)).enable);
  }
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(wait.update(linesWith(false)).enable);
  EXPECT_TRUE(wait.update(linesWith(true)).enable);
}

/// Which lasts longer than the reading that it begins with.
TEST(EnableWait, CountsHowLongALineIsOffBeforeItsDebounce) {
  EnableWait wait = runningWait(5);
  EXPECT_TRUE(wait.update(linesWith(true)).enable);
  EXPECT_FALSE(wait.update(linesWith(false)).enable);
  GpioInputs bouncing = linesWith(false);
  bouncing.is_enable_off = false;
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(wait.update(bouncing).must_go_off);
  EXPECT_FALSE(wait.update(linesWith(true)).enable);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(wait.update(linesWith(false)).must_go_off);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(wait.update(bouncing).must_go_off);
  EXPECT_FALSE(wait.update(linesWith(false)).enable) << "bounces as it goes on";
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
