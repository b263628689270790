#include <gtest/gtest.h>

#include "support/command_run.h"
#include "tactus/cli/commands.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

TEST(Follow, NamesAFileThatIsNotThere) {
  std::string output;
  try {
    test::runCommand(addFollowCommand, {"follow", "/no/such/way.yaml"}, output);
    ADD_FAILURE() << output;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("/no/such/way.yaml:1:1: -: No such file"), 0u)
        << error.what();
  }
}

}  // namespace
}  // namespace tactus
