#include "tactus/record/run_log.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <random>

#include "support/child_process.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/record/log_parts.h"
#include "tactus/record/run_error.h"
#include "tactus/record/run_folder.h"
#include "tactus/record/ulog_format.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

std::string newFolder(const std::string& parent) {
  std::string folder = parent + "tactus_run_log.XXXXXX";
  EXPECT_NE(mkdtemp(folder.data()), nullptr);
  return folder;
}

class RunLogFiles : public ::testing::Test {
 protected:
  explicit RunLogFiles(const std::string& parent = ::testing::TempDir())
      : folder_(newFolder(parent)) {
    scene_.log.min_free_bytes = 0.0;
    ::testing::internal::CaptureStderr();
  }
  ~RunLogFiles() override {
    ::testing::internal::GetCapturedStderr();
    std::filesystem::remove_all(folder_);
  }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  test::ReadLog read(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return test::readLog({std::istreambuf_iterator<char>(in), {}});
  }

  /// So that a file has room for so many cycles.
  void limitTo(int cycles) {
    LogDescription description = describeLog(scene_);
    description.infos.emplace_back("run", "0123456789abcdef");
    description.infos.emplace_back("part", "0");
    scene_.log.max_bytes =
        static_cast<double>(logDefinitions(description).size() + logBytesOfSides(description) +
                            cycles * logBytesACycle(description.shape));
  }

  static CycleRecord cycle(int index) {
    CycleRecord record;
    record.t_s = 0.001 * index;
    return record;
  }

  void writeCycles(RunLog& log, int count) {
    for (int i = 0; i < count; ++i) log.write(cycle(written_++));
  }

  std::size_t filesInFolder() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  Scene scene_ = test::shippedScene("scenario1_null_space");
  std::string folder_;
  int written_ = 0;
};

TEST_F(RunLogFiles, ARunIsCutIntoFilesWithoutLosingABit) {
  constexpr int kCycles = 950, kCyclesAFile = 100;
  limitTo(kCyclesAFile);
  scene_.log.keep = 100;
  std::mt19937_64 random(5);
  std::vector<CycleRecord> records;
  RunLog log(scene_, folder_);
  for (int i = 0; i < kCycles; ++i) {
    records.push_back(test::randomRecord(random));
    log.write(records.back());
    if (i % 7 == 0) log.flush();
  }
  log.close();
  EXPECT_EQ(log.state().files, 10);
  EXPECT_EQ(log.state().stop_reason, "");
  EXPECT_EQ(filesInFolder(), 10u);
  std::vector<std::string> paths;
  std::size_t next = 0;
  const RecordShape shape = describeLog(scene_).shape;
  for (int part = 0; part < 10; ++part) {
    const std::string name = logName(9 - part);
    paths.push_back(path(name));
    const test::ReadLog read_log = read(name);
    EXPECT_FALSE(read_log.cut_off) << name;
    EXPECT_EQ(logPart(read_log.description, name).part, part);
    EXPECT_EQ(read_log.description.sources.size(), scene_.sources.size());
    EXPECT_LE(static_cast<double>(std::filesystem::file_size(path(name))), scene_.log.max_bytes);
    for (const CycleRecord& record : read_log.records) {
      ASSERT_LT(next, records.size());
      ASSERT_EQ(test::loggedWords(record, shape), test::loggedWords(records[next++], shape));
    }
  }
  EXPECT_EQ(next, records.size());
  EXPECT_EQ(checkParts(paths).size(), 10u) << "of one run, in its order";
}

TEST_F(RunLogFiles, TheOldestAreRemoved) {
  limitTo(10);
  scene_.log.keep = 2;
  RunLog log(scene_, folder_);
  writeCycles(log, 45);
  log.close();
  EXPECT_EQ(log.state().files, 3);
  EXPECT_EQ(log.state().removed_files, 2);
  EXPECT_EQ(filesInFolder(), 3u);
  EXPECT_EQ(read("run.2.ulg").records.front().t_s, cycle(20).t_s);
  EXPECT_EQ(read("run.1.ulg").records.front().t_s, cycle(30).t_s);
  EXPECT_EQ(read("run.ulg").records.size(), 5u);
}

TEST_F(RunLogFiles, NoneIsKeptIfNoneShallBe) {
  limitTo(10);
  scene_.log.keep = 0;
  RunLog log(scene_, folder_);
  writeCycles(log, 25);
  log.close();
  EXPECT_EQ(log.state().files, 1);
  EXPECT_EQ(log.state().removed_files, 2);
  EXPECT_EQ(filesInFolder(), 1u);
  EXPECT_EQ(read("run.ulg").records.front().t_s, cycle(20).t_s);
}

TEST_F(RunLogFiles, WithoutALimitThereIsOne) {
  RunLog log(scene_, folder_);
  writeCycles(log, 5000);
  log.close();
  EXPECT_EQ(log.state().files, 1);
  EXPECT_EQ(read("run.ulg").records.size(), 5000u);
}

TEST_F(RunLogFiles, WhatIsFlushedIsInTheFile) {
  RunLog log(scene_, folder_);
  EXPECT_EQ(read("run.ulg").records.size(), 0u) << "its definitions are there at once";
  writeCycles(log, 3);
  log.flush();
  EXPECT_EQ(read("run.ulg").records.size(), 3u);
}

TEST_F(RunLogFiles, ANextFileThatCannotBeBegunStopsTheLogBehindACompleteOne) {
  limitTo(10);
  std::filesystem::create_directories(path("run.next.ulg/in_the_way"));
  RunLog log(scene_, folder_);
  writeCycles(log, 25);
  log.flush();
  log.close();
  const std::string& reason = log.state().stop_reason;
  EXPECT_NE(reason.find("run.next.ulg"), std::string::npos) << reason;
  EXPECT_EQ(log.state().files, 1);
  const test::ReadLog read_log = read("run.ulg");
  EXPECT_EQ(read_log.records.size(), 10u);
  EXPECT_FALSE(read_log.cut_off);
}

TEST_F(RunLogFiles, TheReasonNamesTheFileAsItIsThere) {
  limitTo(1000);
  const bool is_so = test::holdsInChild([this] {
    signal(SIGXFSZ, SIG_IGN);
    RunLog log(scene_, folder_);
    writeCycles(log, 1001);
    test::setLimit(RLIMIT_FSIZE, static_cast<rlim_t>(0.8 * scene_.log.max_bytes));
    writeCycles(log, 999);
    log.flush();
    return log.state().stop_reason == path("run.ulg") + ": cannot be written: File too large";
  });
  EXPECT_TRUE(is_so);
  EXPECT_EQ(read("run.1.ulg").records.size(), 1000u);
  EXPECT_TRUE(read("run.ulg").cut_off);
}

TEST_F(RunLogFiles, AFolderThatVanishesStopsTheLog) {
  scene_.log.min_free_bytes = 1.0;
  RunLog log(scene_, folder_);
  writeCycles(log, 900);
  std::filesystem::remove_all(folder_);
  log.flush();
  EXPECT_EQ(log.state().stop_reason, "") << "the disk is looked at each second";
  writeCycles(log, 200);
  log.flush();
  EXPECT_EQ(log.state().stop_reason, folder_ + ": cannot be looked at: No such file or directory");
  log.close();
}

TEST_F(RunLogFiles, AFileThatIsRemovedStopsTheLog) {
  RunLog log(scene_, folder_);
  writeCycles(log, 900);
  std::filesystem::remove(path("run.ulg"));
  log.flush();
  EXPECT_EQ(log.state().stop_reason, "") << "it is looked at each second";
  writeCycles(log, 200);
  log.flush();
  EXPECT_EQ(log.state().stop_reason, path("run.ulg") + ": was removed");
  log.close();
}

TEST_F(RunLogFiles, AFileThatIsRemovedJustBeforeTheEndIsNoCompleteLog) {
  RunLog log(scene_, folder_);
  writeCycles(log, 10);
  std::filesystem::remove(path("run.ulg"));
  log.close();
  EXPECT_EQ(log.state().stop_reason, path("run.ulg") + ": was removed");
}

TEST_F(RunLogFiles, AReserveThatIsGoneAtTheStartStopsTheLogAtOnceAndSaysSoOnce) {
  scene_.log.min_free_bytes = 1e15;
  RunLog log(scene_, folder_);
  EXPECT_NE(log.state().stop_reason, "");
  writeCycles(log, 3000);
  log.flush();
  log.close();
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(said, "tactusd: log stopped, the run goes on: " + log.state().stop_reason + "\n");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(read("run.ulg").records.size(), 0u);
}

TEST_F(RunLogFiles, OneThatCannotBeBegunIsAnErrorOfTheStart) {
  EXPECT_THROW(RunLog(scene_, folder_ + "/nowhere"), InputError);
  std::filesystem::create_symlink("/dev/full", path("run.ulg"));
  try {
    RunLog log(scene_, folder_);
    ADD_FAILURE();
  } catch (const RunError& error) {
    EXPECT_EQ(error.what(), path("run.ulg") + ": cannot be written: No space left on device");
  }
}

/// Who reads the log of a run that was killed is not led on in the middle of the next one.
TEST_F(RunLogFiles, TheLogOfAnEarlierRunIsNotWrittenTo) {
  const std::string earlier(100000, 'x');
  std::ofstream(path("run.ulg")) << earlier;
  std::ifstream reader(path("run.ulg"));
  RunLog log(scene_, folder_);
  log.close();
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), earlier);
  EXPECT_EQ(read("run.ulg").records.size(), 0u);
}

TEST(LogParts, TellWhetherALogGoesOnWithARun) {
  const auto of = [](const char* run) {
    LogDescription description;
    description.infos = {{kRunKey, run}, {kPartKey, "3"}};
    return description;
  };
  std::optional<std::string> run;
  EXPECT_TRUE(isOfRun(of("a"), "run.ulg", run));
  EXPECT_TRUE(isOfRun(of("a"), "run.ulg", run));
  EXPECT_FALSE(isOfRun(of("b"), "run.ulg", run));
  EXPECT_FALSE(isOfRun(LogDescription{}, "run.ulg", run));
  std::optional<std::string> simulated;
  EXPECT_TRUE(isOfRun(LogDescription{}, "run.ulg", simulated));
  EXPECT_FALSE(isOfRun(LogDescription{}, "run.ulg", simulated));
}

TEST_F(RunLogFiles, AnEarlierRunLeavesNoOlderFilesToANewOne) {
  for (const char* name : {"run.1.ulg", "run.7.ulg", "run.next.ulg", "summary.json", "notes.ulg"})
    std::ofstream(path(name)) << "old";
  const std::filesystem::path folder(folder_);
  const RunFolder run(folder.parent_path().string(), folder.filename().string());
  EXPECT_EQ(filesInFolder(), 1u);
  EXPECT_TRUE(std::filesystem::exists(path("notes.ulg")));
}

/// Where this test alone takes space.
class RunLogInMemory : public RunLogFiles {
 protected:
  RunLogInMemory() : RunLogFiles("/dev/shm/") {}
};

TEST_F(RunLogInMemory, StopsWhenItHasEatenUpToTheReserve) {
  constexpr double kRoom_bytes = 4e6;
  constexpr int kCyclesADrain = 20;
  struct statvfs disk {};
  ASSERT_EQ(statvfs(folder_.c_str(), &disk), 0);
  scene_.log.min_free_bytes =
      static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) - kRoom_bytes;
  RunLog log(scene_, folder_);
  ASSERT_EQ(log.state().stop_reason, "");
  const auto bytes = static_cast<double>(logBytesACycle(describeLog(scene_).shape));
  const int cycles = static_cast<int>(3.0 * kRoom_bytes / bytes);
  while (written_ < cycles && log.state().stop_reason.empty()) {
    writeCycles(log, kCyclesADrain);
    log.flush();
  }
  EXPECT_LT(written_, cycles);
  EXPECT_NE(log.state().stop_reason.find("log.min_free_bytes"), std::string::npos);
  log.close();
  EXPECT_EQ(read("run.ulg").records.size(), static_cast<std::size_t>(written_));
}

}  // namespace
}  // namespace tactus
