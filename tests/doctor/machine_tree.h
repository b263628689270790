#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tactus/doctor/finding.h"

namespace tactus::test {

/// A machine made of files in a folder of this test alone, removed at the end.
class MachineTree {
 public:
  MachineTree() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    root_ = ::testing::TempDir() + "doctor." + test->test_suite_name() + "." + test->name();
    std::filesystem::remove_all(root_);
    std::filesystem::create_directories(root_);
  }
  ~MachineTree() { std::filesystem::remove_all(root_); }
  MachineTree(const MachineTree&) = delete;
  MachineTree& operator=(const MachineTree&) = delete;

  const std::filesystem::path& root() const { return root_; }

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
  void makeFolder(const std::string& path) const {
    std::filesystem::create_directories(root_ / path);
  }
  void link(const std::string& path, const std::string& target) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::filesystem::create_symlink(root_ / target, root_ / path);
  }

 private:
  std::filesystem::path root_;
};

/// The level of the only finding of that name.
inline Level levelOf(const std::vector<Finding>& findings, const std::string& name) {
  EXPECT_EQ(std::ranges::count(findings, name, &Finding::name), 1) << name;
  const auto found = std::ranges::find(findings, name, &Finding::name);
  return found == findings.end() ? Level::kNotFit : found->level;
}

/// What is not in order says why and how to mend it; what is in order does not.
inline void expectMendable(const Finding& finding) {
  const bool is_trouble = finding.level == Level::kWarning || finding.level == Level::kNotFit;
  EXPECT_FALSE(finding.what.empty()) << finding.name;
  EXPECT_EQ(finding.why_it_matters.empty(), !is_trouble) << finding.what;
  EXPECT_EQ(finding.how_to_mend.empty(), !is_trouble) << finding.what;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace tactus::test
