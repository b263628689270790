#include "tactus/daemon/telemetry.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>

#include "support/child_process.h"
#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/daemon/run_status.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

/// A daemon's telemetry with a folder for log and summary, and one for the status.
class TelemetryLog : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  std::string content(const std::string& name) const { return folder_.content(name); }

  /// As the loop does it, `cycles` times.
  void cycle(int cycles) {
    LoopRecord record;
    record.is_in_motion = true;
    for (int i = 0; i < cycles; ++i) {
      record.cycle.t_s = 0.001 * static_cast<double>(cycles_++);
      link_->records.push(record);
      link_->pulse.cycles.fetch_add(1);
    }
  }

  const Scene scene_ = test::shippedScene("scenario1_multi_space");
  const test::RunFolder folder_;
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
  long long cycles_ = 0;
};

TEST_F(TelemetryLog, WhatWasDrainedSurvivesAKill) {
  const pid_t child = fork();
  if (child == 0)
    [&]() noexcept {
      Telemetry telemetry(scene_, folder_.path(), *link_);
      cycle(7);
      telemetry.drain();
      raise(SIGKILL);
    }();
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_EQ(test::readLog(content("run.ulg")).records.size(), 7u);
}

TEST_F(TelemetryLog, AFullDiskStopsTheLogAndNothingElse) {
  constexpr int kRounds = 10, kCyclesARound = 1000;
  const bool has_ended = test::holdsInChild([this] {
    if (!std::freopen(path("stderr").c_str(), "w", stderr)) return false;
    std::setvbuf(stderr, nullptr, _IONBF, 0);
    signal(SIGXFSZ, SIG_IGN);
    Telemetry telemetry(scene_, folder_.path(), *link_);
    test::setLimit(RLIMIT_FSIZE, 1 << 20);
    for (int i = 0; i < kRounds; ++i) {
      cycle(kCyclesARound);
      telemetry.drain();
    }
    link_->reports.push({});  // which is shown at once
    telemetry.drain();
    std::filesystem::rename(path(kStatusName), path("last_status"));
    telemetry.finish({});
    return true;
  });
  EXPECT_TRUE(has_ended);
  const auto log = test::readLog(content("run.ulg"));
  EXPECT_GT(log.records.size(), 1000u);
  EXPECT_LT(log.records.size(), std::size_t{kRounds * kCyclesARound});
  for (std::size_t i = 0; i < log.records.size(); ++i)
    ASSERT_EQ(log.records[i].t_s, 0.001 * static_cast<double>(i));
  const YAML::Node summary = YAML::Load(content("summary.json"));
  EXPECT_EQ(summary["cycles"].as<int>(), kRounds * kCyclesARound);
  EXPECT_EQ(summary["outcome"].as<std::string>(), "completed");
  EXPECT_EQ(summary["log"]["state"].as<std::string>(), "stopped");
  EXPECT_EQ(summary["log"]["files"].as<int>(), 1);
  const std::string reason = path("run.ulg") + ": cannot be written: File too large";
  EXPECT_EQ(summary["log"]["reason"].as<std::string>(), reason);
  const YAML::Node status = YAML::Load(content("last_status"));
  EXPECT_EQ(status["log"]["state"].as<std::string>(), "stopped");
  EXPECT_EQ(status["log"]["reason"].as<std::string>(), reason);
  EXPECT_EQ(content("stderr"),
            "tactusd: log stopped, the run goes on: " + reason + "\ntactusd: boot\n");
}

TEST_F(TelemetryLog, ASummaryThatCannotBeWrittenIsSaidWithTheLogComplete) {
  Telemetry telemetry(scene_, folder_.path(), *link_);
  cycle(3);
  telemetry.drain();
  std::filesystem::create_directories(path("summary.json/in_the_way"));
  try {
    telemetry.finish({});
    ADD_FAILURE();
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find(path("summary.json")), std::string::npos);
  }
  EXPECT_EQ(test::readLog(content("run.ulg")).records.size(), 3u);
}

TEST_F(TelemetryLog, HalfASummaryIsNone) {
  const bool has_failed = test::holdsInChild([this] {
    signal(SIGXFSZ, SIG_IGN);
    Telemetry telemetry(scene_, folder_.path(), *link_);
    test::setLimit(RLIMIT_FSIZE, 100);
    try {
      telemetry.finish({});
    } catch (const RunError&) {
      return true;
    }
    return false;
  });
  EXPECT_TRUE(has_failed);
  EXPECT_FALSE(std::filesystem::exists(path("summary.json")));
}

TEST_F(TelemetryLog, OneThatWasWrittenToTheEndIsComplete) {
  Telemetry telemetry(scene_, folder_.path(), *link_);
  cycle(3);
  telemetry.drain();
  telemetry.finish({});
  const YAML::Node log = YAML::Load(content("summary.json"))["log"];
  EXPECT_EQ(log["state"].as<std::string>(), "complete");
  EXPECT_EQ(log["files"].as<int>(), 1);
  EXPECT_EQ(log["removed_files"].as<int>(), 0);
  EXPECT_FALSE(log["reason"].IsDefined());
}

}  // namespace
}  // namespace tactus
