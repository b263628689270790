#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "support/scene_files.h"
#include "support/shipped_scene.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

/// A directory of its own for files that are none.
class FilesOnDisk : public testing::Test {
 protected:
  FilesOnDisk()
      : directory_(fs::path(testing::TempDir()) /
                   (std::string("tactus_") +
                    testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(directory_);
    fs::create_directories(directory_);
  }
  ~FilesOnDisk() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return (directory_ / name).string(); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }

  void expectLoadError(const std::string& file, const std::string& error) const {
    try {
      loadScene(path(file), {});
      FAIL() << "loaded";
    } catch (const InputError& actual) {
      EXPECT_EQ(actual.what(), error);
    }
  }

  fs::path directory_;
};

std::string errorOfFile(const std::string& file) {
  try {
    loadScene(file, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

constexpr const char* kExpectation = ", expected a readable file of at most 1 MiB";

/// Whoever runs the tests may read all files, but may have no more descriptors than this.
TEST_F(FilesOnDisk, SayWhyTheyCannotBeOpened) {
  write("scene.yaml", "robot: robot.yaml\n");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string error = errorOfFile(path("scene.yaml"));
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(error,
            path("scene.yaml") + ":1:1: -: cannot be opened: Too many open files" + kExpectation);
}

TEST_F(FilesOnDisk, LoadAsFromMemory) {
  const test::SceneFiles files;
  for (const SourceFile& file : files.sources()) write(file.path, file.text);
  const Scene scene = loadScene(path("scene.yaml"), {});
  ASSERT_EQ(scene.sources.size(), 3u);
  EXPECT_EQ(scene.sources[0].path, path("scene.yaml"));
  EXPECT_EQ(scene.sources[0].text, files.scene);
  EXPECT_EQ(scene.sources[2].text, files.urdf);
  const Scene again = loadScene(scene.sources, {});
  EXPECT_EQ(again.name, scene.name);
  EXPECT_EQ(again.controller.q_start, scene.controller.q_start);
}

TEST_F(FilesOnDisk, Missing) {
  expectLoadError("gone.yaml",
                  path("gone.yaml") + ":1:1: -: No such file or directory" + kExpectation);
}

TEST_F(FilesOnDisk, Directory) {
  fs::create_directories(path("scene.yaml"));
  expectLoadError("scene.yaml", path("scene.yaml") + ":1:1: -: is a folder" + kExpectation);
}

TEST_F(FilesOnDisk, FifoDoesNotHang) {
  ASSERT_EQ(mkfifo(path("scene.yaml").c_str(), 0600), 0);
  expectLoadError("scene.yaml", path("scene.yaml") + ":1:1: -: is no regular file" + kExpectation);
}

TEST_F(FilesOnDisk, LinkToItself) {
  fs::create_symlink("scene.yaml", path("scene.yaml"));
  expectLoadError("scene.yaml",
                  path("scene.yaml") + ":1:1: -: Too many levels of symbolic links" + kExpectation);
}

TEST_F(FilesOnDisk, Huge) {
  write("scene.yaml", test::kSceneText + std::string((1 << 20) - test::kSceneText.size() + 1, '#'));
  expectLoadError("scene.yaml",
                  path("scene.yaml") + ":1:1: -: is larger than 1 MiB" + kExpectation);
}

TEST_F(FilesOnDisk, EndlessDevice) {
  fs::create_symlink("/dev/zero", path("scene.yaml"));
  expectLoadError("scene.yaml", path("scene.yaml") + ":1:1: -: is no regular file" + kExpectation);
}

TEST_F(FilesOnDisk, LargestAllowedFileLoads) {
  const test::SceneFiles files;
  for (const SourceFile& file : files.sources()) write(file.path, file.text);
  write("scene.yaml", files.scene + std::string((1 << 20) - files.scene.size(), '#'));
  EXPECT_EQ(loadScene(path("scene.yaml"), {}).duration_s, 13.0);
}

TEST_F(FilesOnDisk, Binary) {
  write("scene.yaml", std::string("robot: \x7f\x45\x4c\x46\x02\x01\x01\x00\x00", 16));
  expectLoadError("scene.yaml", path("scene.yaml") +
                                    ":1:15: -: byte 0x00 is no text, expected a text file in "
                                    "UTF-8");
}

TEST_F(FilesOnDisk, MissingRobotIsAnErrorOfTheLineThatNamesIt) {
  write("scene.yaml", test::kSceneText);
  const std::string place = path("scene.yaml") + ":1:8: robot: " + path("robot.yaml");
  const std::string rest = ", expected the path of a robot.yaml, readable, at most 1 MiB";
  expectLoadError("scene.yaml", place + ": No such file or directory" + rest);
  fs::create_directories(path("robot.yaml"));
  expectLoadError("scene.yaml", place + ": is a folder" + rest);
}

TEST_F(FilesOnDisk, WrongValueOfTheRobotNamesTheScene) {
  test::SceneFiles files;
  files.robot = test::replaced(files.robot, "stiffness_N_per_m: 5000", "stiffness_N_per_m: 0");
  for (const SourceFile& file : files.sources()) write(file.path, file.text);
  try {
    loadScene(path("scene.yaml"), {});
    FAIL() << "loaded";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path("robot.yaml") + ":")) << text;
    EXPECT_TRUE(text.ends_with(" (for the scene " + path("scene.yaml") + ")")) << text;
  }
}

/// Every scene that comes with the project.
class ShippedScene : public testing::TestWithParam<std::string> {};

std::vector<std::string> shippedScenes() {
  std::vector<std::string> paths;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(TACTUS_SOURCE_DIR) / "config" / "scenes")) {
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST_P(ShippedScene, LoadsFromDiskAndFromItsOwnSourcesAlike) {
  const Scene scene = loadScene(GetParam(), {});
  const Scene again = loadScene(scene.sources, {});
  EXPECT_EQ(again.name, scene.name);
  EXPECT_EQ(again.variant, scene.variant);
  EXPECT_EQ(again.joint_names, scene.joint_names);
  EXPECT_EQ(again.controller.q_start, scene.controller.q_start);
  EXPECT_EQ(again.controller.weights, scene.controller.weights);
  EXPECT_EQ(stageNames(again.controller), stageNames(scene.controller));
  EXPECT_EQ(again.sources.size(), scene.sources.size());
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(shippedScenes()));

TEST(ShippedRobots, AreOfEverySize) {
  const auto joints = [](const char* scene) {
    return test::shippedScene(scene).joint_names.size();
  };
  EXPECT_EQ(joints("free_motion"), 9u);
  EXPECT_EQ(joints("robots/planar2_contact"), 2u);
  EXPECT_EQ(joints("robots/ur5e_contact"), 6u);
  EXPECT_EQ(joints("robots/kuka_iiwa7_contact"), 7u);
  EXPECT_EQ(joints("robots/snake16_contact"), 16u);
}

}  // namespace
}  // namespace tactus
