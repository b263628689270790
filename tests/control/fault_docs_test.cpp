#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>
#include <string>

#include "tactus/control/fault.h"
#include "tactus/control/mode.h"

/// The tables of the README are those of the code.
namespace tactus {
namespace {

std::string readme() {
  std::ostringstream text;
  text << std::ifstream(std::string(TACTUS_SOURCE_DIR) + "/README.md").rdbuf();
  return text.str();
}

std::ptrdiff_t rowsBelow(const std::string& text, const std::string& heading) {
  const std::size_t start = text.find(heading);
  EXPECT_NE(start, std::string::npos);
  const std::size_t end = text.find("\n\n", text.find("|---", start));
  const auto lines =
      std::count(text.begin() + static_cast<std::ptrdiff_t>(text.find("|---", start)),
                 text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  return lines;
}

TEST(Readme, HasTheFaultTable) {
  const std::string text = readme();
  std::ptrdiff_t count = 0;
  for (const FaultRow& row : faultTable()) {
    if (row.fault == Fault::kNone) continue;
    ++count;
    const std::string line = std::string("| `") + row.name + "` | " + row.detection + " | " +
                             row.within + " | " + reactionName(row.reaction) + " |";
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(rowsBelow(text, "### Faults"), count);
}

TEST(Readme, HasTheModeTable) {
  const std::string text = readme();
  for (const ModeTransition& row : modeTransitions()) {
    const std::string line =
        std::string("| ") + modeName(row.from) + " | " + modeName(row.to) + " | " + row.when + " |";
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(rowsBelow(text, "### Modes"), kModeTransitionCount);
}

}  // namespace
}  // namespace tactus
