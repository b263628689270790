#include "tactus/record/message.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "support/unread_stderr.h"

namespace tactus {
namespace {

TEST(Message, IsALineOnStandardError) {
  testing::internal::CaptureStderr();
  say("tactile module {} lost at {:.9g} s", "link_3", 3.25);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "tactusd: tactile module link_3 lost at 3.25 s\n");
}

/// A reader that is back learns how many he has missed.
TEST(Message, IsLostWhereNobodyReads) {
  const test::UnreadStderr pipe;
  say("off");
  say("running");
  EXPECT_EQ(pipe.read(), "");
  say("holding");
  say("resting");
  EXPECT_EQ(pipe.read(),
            "tactusd: messages that nobody read and that are lost: 2\ntactusd: holding\n"
            "tactusd: resting\n");
}

TEST(Message, MayBeLongerThanAPipeTakesAtOnce) {
  const test::UnreadStderr pipe;
  pipe.read();
  const std::string text(3 * 4096, 'x');
  say("{}", text);
  EXPECT_EQ(pipe.read(), "tactusd: " + text + "\n");
}

TEST(Message, IsLostWithoutStandardError) {
  const int before = ::dup(STDERR_FILENO);
  ::close(STDERR_FILENO);
  say("off");
  ::dup2(before, STDERR_FILENO);
  ::close(before);
  testing::internal::CaptureStderr();
  say("running");
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "tactusd: messages that nobody read and that are lost: 1\ntactusd: running\n");
}

}  // namespace
}  // namespace tactus
