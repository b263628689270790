#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>
#include <string>

#include "tactus/control/fault.h"
#include "tactus/supervisor/mode.h"

/// The tables of docs/safety.md and of tactusd(8) are those of the code.
namespace tactus {
namespace {

std::string documentText(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(std::string(TACTUS_SOURCE_DIR) + "/" + path).rdbuf();
  return text.str();
}
std::string safetyPage() { return documentText("docs/safety.md"); }

/// From a heading of a manual page to the next.
std::string manualSection(const std::string& heading) {
  const std::string page = documentText("docs/man/tactusd.8");
  const std::size_t start = page.find(".SH " + heading + "\n");
  EXPECT_NE(start, std::string::npos) << heading;
  return page.substr(start, page.find("\n.SH ", start) - start);
}

std::ptrdiff_t countOf(const std::string& text, const std::string& word) {
  std::ptrdiff_t count = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++count;
  return count;
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

TEST(SafetyPage, HasTheFaultTable) {
  const std::string text = safetyPage();
  std::ptrdiff_t count = 0;
  for (const FaultRow& row : faultTable()) {
    if (row.fault == Fault::kNone) continue;
    ++count;
    const std::string line = std::string("| `") + row.name + "` | " + row.detection + " | " +
                             row.within + " | " + reactionName(row.reaction) + " | " + row.remains +
                             " |";
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(rowsBelow(text, "## Faults"), count);
}

TEST(SafetyPage, HasTheModeTable) {
  const std::string text = safetyPage();
  for (const ModeTransition& row : modeTransitions()) {
    const std::string line =
        std::string("| ") + modeName(row.from) + " | " + modeName(row.to) + " | " + row.when + " |";
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(rowsBelow(text, "## Modes"), kModeTransitionCount);
}

TEST(ManualOfTheDaemon, HasTheFaultTable) {
  const std::string faults = manualSection("FAULTS");
  const std::string table = faults.substr(faults.find("What is seen;"));
  std::ptrdiff_t count = 0;
  for (const FaultRow& row : faultTable()) {
    if (row.fault == Fault::kNone) continue;
    ++count;
    const std::string entry = std::string(".TP\n.B ") + row.name + "\n" + row.detection + "; " +
                              row.within + "; " + reactionName(row.reaction) + "; " + row.remains +
                              "\n";
    EXPECT_NE((table + "\n").find(entry), std::string::npos) << entry;
  }
  EXPECT_EQ(countOf(table, ".TP\n"), count);
}

TEST(ManualOfTheDaemon, HasTheModeTable) {
  const std::string modes = manualSection("MODES");
  std::string expected;
  const ModeTransition* before = nullptr;
  for (const ModeTransition& row : modeTransitions()) {
    const bool is_new = !before || before->from != row.from;
    expected += is_new ? std::string(".TP\n.B ") + modeName(row.from) + "\n" : ".br\n";
    expected += std::string("to ") + modeName(row.to) + ": " + row.when + "\n";
    before = &row;
  }
  EXPECT_NE((modes + "\n").find(expected), std::string::npos) << expected;
  EXPECT_EQ(countOf(modes, "\nto "), kModeTransitionCount);
}

}  // namespace
}  // namespace tactus
