#include "tactus/record/output_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include "support/run_folder.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::string contentOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> namesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

/// A device has nothing on the disk.
TEST(OutputFile, SaysThatItIsNotOnTheDisk) {
  OutputFile file("/dev/null");
  EXPECT_THROW(file.sync(), RunError);
}

class ReplacedFile : public testing::Test {
 protected:
  ReplacedFile() { put(path_, "old"); }

  const test::RunFolder run_;
  const fs::path folder_ = run_.path();
  const fs::path path_ = folder_ / "scene.yaml";
};

TEST_F(ReplacedFile, KeepsItsRightsAndWhatItWas) {
  ASSERT_EQ(::chmod(path_.c_str(), 0640), 0);
  put(path_.string() + "~", "older");
  std::string seen;
  replaceFile(path_.string(), "new", [&](const std::string& next) {
    seen = contentOf(next);
    EXPECT_EQ(fs::path(next).parent_path(), fs::canonical(folder_));
    EXPECT_EQ(contentOf(path_), "old");
  });
  EXPECT_EQ(seen, "new");
  EXPECT_EQ(contentOf(path_), "new");
  EXPECT_EQ(contentOf(path_.string() + "~"), "old");
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms(0640));
  EXPECT_EQ(namesIn(folder_), (std::set<std::string>{"scene.yaml", "scene.yaml~"}));
}

TEST_F(ReplacedFile, ComesBackAndLeavesNothingOfWhatTookItsPlace) {
  ASSERT_EQ(::chmod(path_.c_str(), 0640), 0);
  replaceFile(path_.string(), "new");
  replaceWithoutCopy(path_.string(), "old");
  EXPECT_EQ(contentOf(path_), "old");
  EXPECT_EQ(contentOf(path_.string() + "~"), "old");
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms(0640));
  EXPECT_EQ(namesIn(folder_), (std::set<std::string>{"scene.yaml", "scene.yaml~"}));
}

TEST_F(ReplacedFile, StaysItsOwners) {
  const bool is_root = ::geteuid() == 0;  // who alone may give a file away
  const uid_t owner = is_root ? 1 : ::geteuid();
  ASSERT_EQ(::chown(path_.c_str(), owner, static_cast<gid_t>(-1)), 0);
  const auto ownerNow = [&] {
    struct stat now {};
    EXPECT_EQ(::stat(path_.c_str(), &now), 0);
    return now.st_uid;
  };
  replaceFile(path_.string(), "new");
  EXPECT_EQ(ownerNow(), owner);
  replaceWithoutCopy(path_.string(), "newer");
  EXPECT_EQ(ownerNow(), owner);
}

TEST_F(ReplacedFile, LinkStaysALink) {
  const fs::path link = folder_ / "link.yaml";
  fs::create_symlink("scene.yaml", link);
  replaceFile(link.string(), "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(contentOf(path_), "new");
  EXPECT_EQ(namesIn(folder_), (std::set<std::string>{"link.yaml", "scene.yaml", "scene.yaml~"}));
}

TEST_F(ReplacedFile, IsWrittenAsAWholeWhateverIsThere) {
  const fs::path link = folder_ / "link.yaml", fresh = folder_ / "fresh.yaml";
  const fs::path dangling = folder_ / "dangling.yaml";
  fs::create_symlink("scene.yaml", link);
  fs::create_symlink("later.yaml", dangling);
  for (const fs::path& path : {link, fresh, dangling}) writeWhole(path.string(), "new");
  EXPECT_TRUE(fs::is_symlink(link) && fs::is_symlink(dangling));
  EXPECT_EQ(contentOf(path_) + contentOf(fresh) + contentOf(folder_ / "later.yaml"), "newnewnew");
  EXPECT_EQ(namesIn(folder_), (std::set<std::string>{"dangling.yaml", "fresh.yaml", "later.yaml",
                                                     "link.yaml", "scene.yaml"}));
  EXPECT_EQ(fs::status(fresh).permissions(), fs::status(path_).permissions());
  EXPECT_THROW(writeWhole((folder_ / "none" / "x").string(), "new"), std::runtime_error);
  EXPECT_THROW(writeWhole("/dev/full", "new"), RunError);
}

TEST_F(ReplacedFile, WhatTheCheckThrowsLeavesAllAsItWas) {
  const auto refuse = [](const std::string&) { throw std::runtime_error("no"); };
  EXPECT_THROW(replaceFile(path_.string(), "new", refuse), std::runtime_error);
  EXPECT_EQ(contentOf(path_), "old");
  EXPECT_EQ(namesIn(folder_), std::set<std::string>{"scene.yaml"});
}

TEST_F(ReplacedFile, FailureLeavesNothingBehind) {
  fs::create_directories(path_.string() + "~/in the way");
  EXPECT_THROW(replaceFile(path_.string(), "new"), RunError);
  EXPECT_EQ(contentOf(path_), "old");
  EXPECT_EQ(namesIn(folder_), (std::set<std::string>{"scene.yaml", "scene.yaml~"}));
}

TEST_F(ReplacedFile, TakesNobodyElsesName) {
  put(path_.string() + ".next", "mine");
  replaceFile(path_.string(), "new");
  EXPECT_EQ(contentOf(path_.string() + ".next"), "mine");
}

}  // namespace
}  // namespace tactus
