#include <gtest/gtest.h>

#include "support/command_run.h"
#include "tactus/cli/commands.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

std::string explained(const std::string& key) {
  std::string output;
  EXPECT_EQ(test::runCommand(addKeysCommand, {"keys", key}, output), 0);
  return output;
}

/// As --set spells them.
TEST(Keys, OfARobotAreFoundBehindTheirWord) {
  EXPECT_EQ(explained("robot.drives.position_lag_s"), explained("drives.position_lag_s"));
  EXPECT_EQ(explained("robot.limits").find("robot, see tactus-robot(5)"), 0u);
  EXPECT_EQ(explained("robot.home[0]"), explained("robot.home"));
  EXPECT_NE(explained("robot").find("scene, see tactus-scene(5)\n  robot\n"), std::string::npos);
}

TEST(Keys, OfASceneAreNoneOfARobot) {
  for (const char* const key : {"robot.damping", "robot.limts", "robot."}) {
    std::string output;
    EXPECT_THROW(test::runCommand(addKeysCommand, {"keys", key}, output), InputError) << key;
  }
}

}  // namespace
}  // namespace tactus
