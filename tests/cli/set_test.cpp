#include <gtest/gtest.h>

#include "support/command_run.h"
#include "tactus/cli/commands.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

/// Before any daemon is asked.
TEST(Set, RefusesAKeyThatIsGivenTwice) {
  std::string output;
  try {
    test::runCommand(
        addSetCommand,
        {"set", "controller.damping=0.5", "controller.order=2", "controller.damping=0.6"}, output);
    ADD_FAILURE() << output;
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "set:1:1: controller.damping: is given twice, expected each key once");
  }
}

}  // namespace
}  // namespace tactus
