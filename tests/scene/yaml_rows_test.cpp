#include "tactus/scene/yaml_rows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/random.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

using Rows = std::vector<std::string>;

std::string withNewRows(const std::string& text, const char* key, const Rows& rows) {
  return withRows({"robot.yaml", text}, key, rows, "new");
}

TEST(YamlRows, ReplacesRowsAndKeepsAllElse) {
  EXPECT_EQ(
      withNewRows("a:\n  c:  # what\n    - [1, 2]  # one\n    # between\n    -  [3,\n"
                  "       4]  # two ]\n  d: 1\n",
                  "a.c", {"[5, 6]", "[7, 8]"}),
      "a:\n  c:  # what\n    - [5, 6]  # one\n    # between\n    -  [7, 8]  # two ]\n  d: 1\n");
  EXPECT_EQ(withNewRows("a: [{c: [[1, 2], [3, 4]], d: 1}]\n", "a[0].c", {"[5]", "[6]"}),
            "a: [{c: [[5], [6]], d: 1}]\n");
  EXPECT_EQ(withNewRows("c:\n- [1, # [\n   2]\n", "c", {"[5]"}), "c:\n- [5]\n");
}

TEST(YamlRows, PutsOneMoreBehindTheLast) {
  EXPECT_EQ(withNewRows("a:\n  c:\n    - [1]  # one\n  d: 1\n", "a.c", {"[5]", "[6]"}),
            "a:\n  c:\n    - [5]  # one\n    - [6]  # new\n  d: 1\n");
  EXPECT_EQ(withNewRows("c: [[1], [2]]  # x", "c", {"[5]", "[6]", "[7]"}),
            "c: [[5], [6], [7]]  # x");
  EXPECT_EQ(withNewRows("c:\n  - [1]", "c", {"[5]", "[6]"}), "c:\n  - [5]\n  - [6]  # new");
}

TEST(YamlRows, RefusesWhatIsNoTableOrHasOtherRows) {
  EXPECT_THROW(withNewRows("c: 1\n", "c", {"[1]"}), InputError);
  EXPECT_THROW(withNewRows("c: []\n", "c", {"[1]"}), InputError);
  EXPECT_THROW(withNewRows("d: 1\n", "c", {"[1]"}), InputError);
  EXPECT_THROW(withNewRows("c: [[1], [2]]\n", "c", {"[1]"}), InputError);
  EXPECT_THROW(withNewRows("c: [[1]]\n", "c", {"[1]", "[1]", "[1]"}), InputError);
  EXPECT_THROW(withNewRows("c:\n  - - 1\n    - 2\n", "c", {"[1]"}), InputError);
}

/// Whatever the layout: what is written is read, and other keys and comments are as before.
TEST(YamlRows, WhatIsWrittenIsRead) {
  test::Random random(51);
  for (int i = 0; i < 500; ++i) {
    const bool is_flow = random.chance(0.3);
    const int count = random.integer(1, 5), added = random.integer(0, 1);
    const std::string pad(static_cast<std::size_t>(random.integer(2, 6)), ' ');
    std::string text = "# top\nx: {y: [1, 2]}\nmodules:\n  - link: a\n    table:";
    if (is_flow) text += " [";
    for (int row = 0; row < count; ++row) {
      const std::string numbers = fmt::format("[{}, {}]", random.integer(0, 9), row);
      if (is_flow)
        text += (row > 0 ? ", " : "") + numbers;
      else
        text += "\n  " + pad + "- " + numbers + (random.chance(0.5) ? "  # [note" : "");
    }
    text += is_flow ? "]\n" : "\n";
    text += "    z: 3  # end\n";
    Rows rows;
    for (int row = 0; row < count + added; ++row)
      rows.push_back(fmt::format("[{}, {}, {}]", row, random.integer(-999, 999), 0.5));
    const std::string edited = withNewRows(text, "modules[0].table", rows);
    const YamlNode root = parseYaml({"robot.yaml", edited});
    const YamlNode* table = findGiven(root, "modules[0].table");
    ASSERT_TRUE(table && table->items.size() == rows.size()) << edited;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const YamlNode& read = table->items[row];
      ASSERT_EQ(read.items.size(), 3u);
      EXPECT_EQ(
          fmt::format("[{}, {}, {}]", read.items[0].text, read.items[1].text, read.items[2].text),
          rows[row]);
    }
    EXPECT_EQ(findGiven(root, "modules[0].z")->text, "3");
    EXPECT_EQ(edited.substr(0, edited.find("table")), text.substr(0, text.find("table")));
    const auto notes = [](const std::string& of) {
      std::size_t found = 0;
      for (std::size_t at = of.find("[note"); at != std::string::npos;
           at = of.find("[note", at + 1))
        ++found;
      return found;
    };
    EXPECT_EQ(notes(edited), notes(text));
  }
}

}  // namespace
}  // namespace tactus
