#include "tactus/scene/yaml_word.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

TEST(YamlWord, IsReadBackAsTextWhateverTheName) {
  test::Random random(3);
  const std::string characters = "aB0_-./ :#,{}[]'\"\\&*!|>%@`~?\n\t=\x7f";
  std::vector<std::string> names = {
      "",    "~",    "null", "True", "no",    "1",           "0x10", "1e3",           ".inf",
      "- a", "a: b", "a #b", "ü",    "link1", "../a/b.urdf", "🦾", "a\\ud83d🦾b", "\\🦾",
      "𐀀"};
  for (int i = 0; i < 2000; ++i) {
    std::string name;
    for (int k = random.integer(1, 6); k > 0; --k)
      name +=
          characters[static_cast<std::size_t>(random.index(static_cast<int>(characters.size())))];
    names.push_back(name);
  }
  for (const std::string& name : names) {
    const YamlNode block = parseYaml({"a.yaml", "key: " + yamlWord(name) + "\n"});
    ASSERT_NE(block.find("key"), nullptr) << name;
    EXPECT_EQ(block.find("key")->text, name);
    EXPECT_EQ(block.find("key")->kind, YamlNode::Kind::kScalar) << name;
    const YamlNode flow = parseYaml({"a.yaml", "{key: " + yamlWord(name) + ", b: 1}"});
    EXPECT_EQ(flow.find("key")->text, name);
  }
  EXPECT_EQ(yamlWord("link_1"), "link_1");
  EXPECT_EQ(yamlWord("../a/b.urdf"), "../a/b.urdf");
}

}  // namespace
}  // namespace tactus
