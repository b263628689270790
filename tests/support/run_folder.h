#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace tactus::test {

/// A folder for what a daemon writes, its status too; removed at the end.
class RunFolder {
 public:
  RunFolder() : path_(::testing::TempDir() + "tactus_run.XXXXXX") {
    EXPECT_NE(mkdtemp(path_.data()), nullptr);
    setenv("RUNTIME_DIRECTORY", path_.c_str(), 1);
  }
  ~RunFolder() {
    unsetenv("RUNTIME_DIRECTORY");
    std::filesystem::remove_all(path_);
  }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::string& path() const { return path_; }
  bool has(const std::string& name) const { return std::filesystem::exists(path_ + "/" + name); }
  std::string content(const std::string& name) const {
    std::ifstream in(path_ + "/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  std::string path_;
};

}  // namespace tactus::test
