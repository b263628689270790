#include "tactus/scene/yaml_edit.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

std::string edited(const std::string& text, const char* key, const char* value = "0.6") {
  return withValue({"scene.yaml", text}, key, value);
}

TEST(YamlEdit, ReplacesAValueAndNothingElse) {
  EXPECT_EQ(edited("controller:\n  damping: 0.5  # as found\n  order: 2\n", "controller.damping"),
            "controller:\n  damping: 0.6  # as found\n  order: 2\n");
  EXPECT_EQ(edited("controller: {order: 2, damping: 0.5}\n", "controller.damping"),
            "controller: {order: 2, damping: 0.6}\n");
  EXPECT_EQ(edited("a: {b: {c: '1'}} # x", "a.b.c"), "a: {b: {c: 0.6}} # x");
  EXPECT_EQ(edited("a:\n  b: ~\n", "a.b"), "a:\n  b: 0.6\n");
}

/// Columns do not count it, bytes do.
TEST(YamlEdit, IsRightBehindAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(edited(mark + "a: {b: 0.5}\n", "a.b"), mark + "a: {b: 0.6}\n");
  EXPECT_EQ(edited(mark + "a: {c: 1}\n", "a.b"), mark + "a: {b: 0.6, c: 1}\n");
  EXPECT_EQ(edited(mark + "x: 1\na: {b: 0.5}\n", "a.b"), mark + "x: 1\na: {b: 0.6}\n");
}

TEST(YamlEdit, PutsANewOneIntoItsSection) {
  EXPECT_EQ(edited("controller:\n    # law\n    order: 2\n", "controller.damping"),
            "controller:\n    # law\n    damping: 0.6\n    order: 2\n");
  EXPECT_EQ(edited("controller: {order: 2}\n", "controller.damping"),
            "controller: {damping: 0.6, order: 2}\n");
  EXPECT_EQ(edited("controller: {order: 2}\n", "controller.transition.distance_m"),
            "controller: {transition: {distance_m: 0.6}, order: 2}\n");
  EXPECT_EQ(edited("controller:\n  order: 2\n", "controller.transition.distance_m"),
            "controller:\n  transition:\n    distance_m: 0.6\n  order: 2\n");
  EXPECT_EQ(edited("extends: other.yaml", "controller.damping"),
            "extends: other.yaml\ncontroller:\n  damping: 0.6\n");
  EXPECT_EQ(edited("", "controller.damping"), "controller:\n  damping: 0.6\n");
}

/// As editors of Windows write them.
TEST(YamlEdit, EndsLinesAsTheFileDoes) {
  EXPECT_EQ(edited("a:\r\n  b: 1 # x\r\n", "a.b"), "a:\r\n  b: 0.6 # x\r\n");
  EXPECT_EQ(edited("a:\r\n  b: 1\r\n", "a.c"), "a:\r\n  c: 0.6\r\n  b: 1\r\n");
  EXPECT_EQ(edited("a: 1\r\nb: 2", "c.d"), "a: 1\r\nb: 2\r\nc:\r\n  d: 0.6\r\n");
  EXPECT_EQ(edited("a:\r\n  - b: 1", "a[0].c"), "a:\r\n  - b: 1\r\n    c: 0.6\r\n");
}

TEST(YamlEdit, GoesIntoListsThatAreThere) {
  const std::string block =
      "a:\n  b:\n    - name: x\n      # sign\n      sign: 1\n    - {name: y}\n";
  EXPECT_EQ(edited(block, "a.b[0].sign", "-1"),
            "a:\n  b:\n    - name: x\n      # sign\n      sign: -1\n    - {name: y}\n");
  EXPECT_EQ(
      edited(block, "a.b[0].offset"),
      "a:\n  b:\n    - name: x\n      offset: 0.6\n      # sign\n      sign: 1\n    - {name: y}\n");
  EXPECT_EQ(edited(block, "a.b[1].sign", "-1"),
            "a:\n  b:\n    - name: x\n      # sign\n      sign: 1\n    - {sign: -1, name: y}\n");
  EXPECT_EQ(edited("a: [1, 2, 3] # c\n", "a[1]"), "a: [1, 0.6, 3] # c\n");
  for (const char* key : {"a.b[2].sign", "a.b[-1].sign", "a.b[0].c[0]", "a.c[0]", "a.b[x]", "a[0]"})
    EXPECT_THROW(edited(block, key), InputError) << key;
  EXPECT_EQ(edited("a:\n  - b: 1", "a[0].c"), "a:\n  - b: 1\n    c: 0.6\n");
  EXPECT_THROW(edited("a:\n  - b: {}\n", "a[0].c"), InputError);
}

TEST(YamlEdit, RefusesWhereThereIsNoRoom) {
  EXPECT_THROW(edited("controller: ~\n", "controller.damping"), InputError);
  EXPECT_THROW(edited("controller: 3\n", "controller.damping"), InputError);
  EXPECT_THROW(edited("controller: {damping: {x: 1}}\n", "controller.damping"), InputError);
  EXPECT_THROW(edited("controller: [\n", "controller.damping"), InputError);
}

/// Whatever the file looks like: the value is there afterwards, or it was refused.
TEST(YamlEdit, WhatIsWrittenIsRead) {
  test::Random random(1941);
  const std::vector<std::string> texts = {"a:\n  b: 1\n  c:\n    d: 2\n",
                                          "a: {b: 1, c: {d: 2}}\n",
                                          "# top\na:\n  c: {d: 2} # end\n",
                                          "x: 1\n",
                                          "a:\n  c:\n      e: [1, 2]\n  b: \"1\"\n",
                                          "{a: {b: 1}}\n"};
  for (int i = 0; i < 2000; ++i) {
    std::string text =
        texts[static_cast<std::size_t>(random.index(static_cast<int>(texts.size())))];
    for (const char* key : {"a.b", "a.c.d", "a.c.f", "x", "y.z"}) {
      if (!random.chance(0.5)) continue;
      const std::string value = std::to_string(random.integer(0, 1000));
      try {
        text = withValue({"s", text}, key, value);
      } catch (const InputError&) {
        continue;
      }
      try {
        const YamlNode root = parseYaml({"s", text});
        const YamlNode* const read = findGiven(root, key);
        ASSERT_TRUE(read) << text;
        ASSERT_EQ(read->text, value) << text;
      } catch (const InputError&) {
        // A file that is one flow map has no room below it.
        ASSERT_EQ(text[0], '{') << text;
        break;
      }
    }
  }
}

}  // namespace
}  // namespace tactus
