#include "tactus/record/growing_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <istream>
#include <iterator>
#include <string>

#include "support/run_folder.h"

namespace tactus {
namespace {

void writeText(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string textOf(GrowingFile& file) {
  std::istream in(&file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(GrowingFile, EndsWithTheRun) {
  const test::RunFolder folder;
  const std::string path = folder.path() + "/run.ulg";
  writeText(path, "all");
  writeText(folder.path() + "/summary.json", "{}");
  GrowingFile file(path);
  EXPECT_EQ(textOf(file), "all");
  EXPECT_FALSE(file.goesOn());
  EXPECT_TRUE(file.isLive());
}

/// Also where the run has ended before its last file was looked at.
TEST(GrowingFile, GoesOnInTheLastFileOfARunThatIsOver) {
  const test::RunFolder folder;
  const std::string path = folder.path() + "/run.ulg";
  writeText(path, "older");
  GrowingFile older(path);
  std::filesystem::rename(path, folder.path() + "/run.1.ulg");
  writeText(path, "newest");
  writeText(folder.path() + "/summary.json", "{}");
  EXPECT_EQ(textOf(older), "older");
  EXPECT_TRUE(older.goesOn());
  GrowingFile newest(path);
  EXPECT_EQ(textOf(newest), "newest");
  EXPECT_FALSE(newest.goesOn());
}

}  // namespace
}  // namespace tactus
