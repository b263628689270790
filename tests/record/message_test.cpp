#include "tactus/record/message.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <string>

#include "support/unread_stderr.h"

namespace tactus {
namespace {

/// What tests before have lost is told.
class Message : public testing::Test {
 protected:
  Message() {
    testing::internal::CaptureStderr();
    say("begins");
    testing::internal::GetCapturedStderr();
  }
};

TEST_F(Message, IsALineOnStandardError) {
  testing::internal::CaptureStderr();
  say("tactile module {} lost at {:.9g} s", "link_3", 3.25);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "tactusd: tactile module link_3 lost at 3.25 s\n");
}

/// A reader that is back learns how many he has missed.
TEST_F(Message, IsLostWhereNobodyReads) {
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

TEST_F(Message, MayBeLongerThanAPipeTakesAtOnce) {
  const test::UnreadStderr pipe;
  pipe.read();
  const std::string text(3 * 4096, 'x');
  say("{}", text);
  EXPECT_EQ(pipe.read(), "tactusd: " + text + "\n");
}

/// poll() tells of room in a terminal where a byte fits.
TEST_F(Message, WaitsForNoTerminalEither) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(master, 0);
  ASSERT_EQ(::grantpt(master), 0);
  ASSERT_EQ(::unlockpt(master), 0);
  const int terminal = ::open(::ptsname(master), O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  const int before = ::dup(STDERR_FILENO);
  ::dup2(terminal, STDERR_FILENO);
  const std::string text(700, 'x');
  for (int i = 0; i < 40; ++i) say("{}", text);
  const bool waits = (::fcntl(STDERR_FILENO, F_GETFL) & O_NONBLOCK) == 0;
  ::dup2(before, STDERR_FILENO);
  for (const int descriptor : {before, terminal, master}) ::close(descriptor);
  EXPECT_TRUE(waits) << "it is as it was for all others";
}

TEST_F(Message, IsLostWithoutStandardError) {
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
