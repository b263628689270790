#include <gtest/gtest.h>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "tactus/cli/commands.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

std::string refusedMove(const std::vector<std::string>& options) {
  std::vector<std::string> words = {"move", "--relative", "--to-posture"};
  words.insert(words.end(), options.begin(), options.end());
  const test::RunFolder nobody_runs_here;
  std::string output;
  try {
    test::runCommand(addMoveCommand, words, output);
  } catch (const InputError& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("told to a daemon: ") + error.what();
  }
  return output;
}

/// As of a variable that is not set: the rest of the order would move the arm.
TEST(Move, RefusesATextThatIsEmpty) {
  const std::string expected = ": is empty, expected three numbers, such as 0.9,-,0.25";
  EXPECT_EQ(refusedMove({"--to", ""}), "--to" + expected);
  EXPECT_EQ(refusedMove({"--rotate", ""}), "--rotate" + expected);
  EXPECT_EQ(refusedMove({"--to", "0,-,0.1", "--rotate", ""}), "--rotate" + expected);
}

TEST(Move, TellsTheDaemonANumberForEach) {
  EXPECT_EQ(refusedMove({"--to", "0,-"}).find("--to 0,-: has 2 numbers, expected three"), 0u);
  EXPECT_EQ(refusedMove({"--to", "0,-,0.1"}).find("told to a daemon: "), 0u);
}

}  // namespace
}  // namespace tactus
