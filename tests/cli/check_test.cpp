#include <gtest/gtest.h>

#include <fstream>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "tactus/cli/commands.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

/// Whoever has none yet is told to have them proposed.
TEST(Check, ProposesCapsulesForASceneThatNeedsThem) {
  const test::RunFolder folder;
  const std::string scene = folder.path() + "/clear.yaml";
  std::ofstream(scene) << "extends: " TACTUS_SOURCE_DIR
                          "/config/scenes/robots/ur5e_free.yaml\n"
                          "clearance: {}\n";
  std::string output;
  EXPECT_THROW(test::runCommand(addCheckCommand, {"check", scene}, output), InputError);
  EXPECT_EQ(test::runCommand(addCheckCommand, {"check", "--capsules", scene}, output), kExitDone);
  EXPECT_NE(output.find("collision_capsules:\n  - {link: "), std::string::npos) << output;
}

}  // namespace
}  // namespace tactus
