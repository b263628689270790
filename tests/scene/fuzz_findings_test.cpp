#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "fuzz/loader_input.h"

namespace tactus {
namespace {

/// What the fuzzer once found stays mended.
TEST(FuzzFindings, EndAsTheyShould) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(TACTUS_SOURCE_DIR) / "tests" / "fuzz" / "findings")) {
    std::ostringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    EXPECT_NO_THROW(fuzz::loadAndRun(text.str())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace tactus
