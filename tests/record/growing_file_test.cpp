#include "tactus/record/growing_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <istream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include "support/run_folder.h"
#include "tactus/record/output_file.h"

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

/// What it wrote last is read all the same.
TEST(GrowingFile, EndsWithAWriterThatIsGone) {
  const test::RunFolder folder;
  const std::string path = folder.path() + "/run.ulg";
  auto writer = std::make_unique<OutputFile>(path);
  writer->showThatItGrows();
  writer->append("first");
  writer->flush();
  GrowingFile file(path);
  std::istream in(&file);
  std::string text(5, ' ');
  in.read(text.data(), 5);
  EXPECT_EQ(text, "first");
  std::future<std::string> rest = std::async(
      std::launch::async, [&in] { return std::string(std::istreambuf_iterator<char>(in), {}); });
  while (!file.isLive()) std::this_thread::yield();
  writer->append("last");
  writer.reset();  // as the kernel does for one that was killed
  EXPECT_EQ(rest.get(), "last");
  EXPECT_FALSE(file.goesOn());
}

}  // namespace
}  // namespace tactus
