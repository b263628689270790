#include "tactus/daemon/run_status.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/cli/commands.h"
#include "tactus/daemon/running_log.h"
#include "tactus/daemon/telemetry.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

/// A daemon's telemetry with a folder for its status, and `tactus status` that looks there.
class RunStatusFile : public ::testing::Test {
 protected:
  std::string path() const { return folder_.path() + "/" + kStatusName; }

  int run(std::vector<std::string> options = {}) {
    options.insert(options.begin(), "status");
    return test::runCommand(addStatusCommand, std::move(options), output_);
  }

  std::string errorOfRun(const std::vector<std::string>& options = {}) {
    try {
      run(options);
    } catch (const RunError& error) {
      return error.what();
    }
    return "no error";
  }

  void cycle(bool is_in_motion, double force_N) {
    LoopRecord record;
    record.is_in_motion = is_in_motion;
    record.cycle.force_sensor_N[0] = force_N;
    record.cycle.stiffness_N_per_m = 7000.0;
    record.cycle.wake_latency_ns = 4000;
    record.cycle.step_ns = 9000;
    link_->records.push(record);
    link_->pulse.cycles.fetch_add(1);
  }

  void reportMode(Mode mode, Fault fault) const {
    ModeReport report;
    report.mode = mode;
    report.fault = fault;
    link_->reports.push(report);
  }

  const Scene scene_ = test::shippedScene("scenario1_multi_space");
  const test::RunFolder folder_;
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
  std::string output_;
};

TEST_F(RunStatusFile, ShowsTheRunningDaemonUntilItEnds) {
  {
    Telemetry telemetry(scene_, "", *link_);
    reportMode(Mode::kRunning, Fault::kNone);
    cycle(true, 6.0);
    cycle(true, 4.5);
    link_->pulse.missed_cycles = 3;
    telemetry.drain();
    EXPECT_EQ(run(), kExitDone);
    for (const char* expected :
         {"scenario1_multi_space (null_task)", "\nrunning\n", "force    4.50 N, at most 6.00 N",
          "obstacle taken for 7000 N/m", "cycles   2, 3 missed, 0 not logged", "wakes    4.0 us"})
      EXPECT_NE(output_.find(expected), std::string::npos) << expected << " in\n" << output_;
    EXPECT_EQ(output_.find("waits "), std::string::npos) << output_;
    EXPECT_EQ(run({"--json"}), kExitDone);
    const YAML::Node json = YAML::Load(output_);
    EXPECT_EQ(json["mode"].as<std::string>(), "running");
    EXPECT_EQ(json["motion"]["peak_force_N"].as<double>(), 6.0);
    EXPECT_EQ(json["pid"].as<int>(), getpid());
  }
  EXPECT_FALSE(std::filesystem::exists(path()));
  EXPECT_EQ(errorOfRun(), path() + ": " + kNoDaemon);
}

TEST_F(RunStatusFile, NamesAFaultAndEndsSo) {
  Telemetry telemetry(scene_, "", *link_);
  reportMode(Mode::kFault, Fault::kEmergencyStop);
  link_->pulse.way_on = WayOn{WaitsFor::kEnableOff};
  cycle(false, 0.0);
  telemetry.drain();
  EXPECT_EQ(run(), kExitFault);
  EXPECT_NE(output_.find("fault: emergency_stop"), std::string::npos) << output_;
  EXPECT_NE(output_.find("waits    for the enable line to be switched off, then on\n"),
            std::string::npos)
      << output_;
  EXPECT_EQ(output_.find("force"), std::string::npos) << "it has not moved:\n" << output_;
}

TEST_F(RunStatusFile, SaysOfEveryFaultWhatToDo) {
  const std::string description = "fault";
  const LoopFigures loop;
  for (const FaultRow& row : faultTable()) {
    std::ofstream(path()) << jsonText(statusJson(
        {scene_, Mode::kFault, row.fault, description, {}, loop, nullptr}, monotonicTime_s()));
    EXPECT_EQ(run(), row.fault == Fault::kNone ? kExitDone : kExitFault);
    const std::string line = "\ndo       " + std::string(row.remedy) + "\n";
    EXPECT_EQ(output_.find(line) != std::string::npos, row.fault != Fault::kNone) << output_;
    EXPECT_EQ(output_.find("\ndo ") != std::string::npos, row.fault != Fault::kNone) << output_;
  }
}

/// Of an e-stop that is released the bus may be left, which has no power.
TEST_F(RunStatusFile, SaysWhatToDoAboutTheFaultThatIsWaitedFor) {
  Telemetry telemetry(scene_, "", *link_);
  reportMode(Mode::kFault, Fault::kEmergencyStop);
  link_->pulse.way_on = WayOn{WaitsFor::kFaultGone, Fault::kBusOff};
  cycle(false, 0.0);
  telemetry.drain();
  EXPECT_EQ(run(), kExitFault);
  const std::string lines = "waits    for bus_off to be gone\ndo       ";
  EXPECT_NE(output_.find(lines + faultRow(Fault::kBusOff).remedy), std::string::npos) << output_;
}

TEST_F(RunStatusFile, AStatusThatIsOldIsNone) {
  const std::string description = "running";
  std::ofstream(path()) << jsonText(
      statusJson({scene_, Mode::kRunning, Fault::kNone, description, {}, {}, nullptr},
                 monotonicTime_s() - 60.0));
  EXPECT_EQ(errorOfRun(), path() + ": no word from the daemon for 60 s");
  EXPECT_NE(output_.find("running"), std::string::npos) << "the last word is worth knowing";
  EXPECT_EQ(errorOfRun({"--json"}), path() + ": no word from the daemon for 60 s");
  EXPECT_EQ(output_, "") << "a program would take it for that of now";
}

TEST_F(RunStatusFile, AStatusOfTheTimeToComeIsNone) {
  const std::string description = "running";
  std::ofstream(path()) << jsonText(
      statusJson({scene_, Mode::kRunning, Fault::kNone, description, {}, {}, nullptr},
                 monotonicTime_s() + 60.0));
  EXPECT_EQ(errorOfRun(), path() + ": is of before this computer started");
}

/// One that was killed leaves its status, and its log that grows no more.
TEST_F(RunStatusFile, NamesTheLogOfADaemonThatRunsAlone) {
  const auto said = [&](double age_s) -> std::string {
    std::ofstream(path()) << Json(
        {{"monotonic_s", monotonicTime_s() - age_s}, {"log", {{"folder", "/runs/here"}}}});
    try {
      return runningLog();
    } catch (const RunError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(said(0.0), "/runs/here/run.ulg");
  EXPECT_EQ(said(60.0), path() + ": no word from the daemon for 60 s; a log may be named, too");
  EXPECT_EQ(said(-60.0), path() + ": is of before this computer started; a log may be named, too");
  std::ofstream(path()) << "{";
  EXPECT_THROW(runningLog(), RunError);
}

TEST_F(RunStatusFile, OtherFilesAreRefused) {
  for (const char* text :
       {"", "{", "[1, 2]", "{\"monotonic_s\": 1e300}", "\xff\xfe{}", "a: &a [*a]"}) {
    std::ofstream(path()) << text;
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--json"}}) {
      EXPECT_EQ(errorOfRun(options), path() + ": not the status of a daemon") << text;
      EXPECT_EQ(output_, "") << text;
    }
  }
  std::filesystem::remove(path());
  std::filesystem::create_directory(path());
  EXPECT_EQ(errorOfRun(), path() + ": not a file");
}

TEST_F(RunStatusFile, ANumberThatIsNoneIsShownAsSuch) {
  Telemetry telemetry(scene_, "", *link_);
  cycle(true, std::nan(""));
  telemetry.drain();
  EXPECT_EQ(run(), kExitDone);
  EXPECT_NE(output_.find("force    nan N"), std::string::npos) << output_;
}

TEST_F(RunStatusFile, AFolderThatCannotBeWrittenEndsNothing) {
  const std::string elsewhere = folder_.path() + ".away";
  std::filesystem::rename(folder_.path(), elsewhere);
  StatusFile file;
  EXPECT_TRUE(file.isDue());
  const std::string description = "running";
  const LoopFigures loop;
  const RunStatus status{scene_, Mode::kRunning, Fault::kNone, description, {}, loop, nullptr};
  ::testing::internal::CaptureStderr();
  file.write(status);
  file.write(status);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("tactusd: no status: "), std::string::npos) << said;
  EXPECT_EQ(said.find("no status", said.find("no status") + 1), std::string::npos) << said;
  std::filesystem::rename(elsewhere, folder_.path());
  file.write(status);
  EXPECT_EQ(run(), kExitDone) << "what hindered it has gone";
}

TEST_F(RunStatusFile, TellsALogThatHasStoppedFromOneThatIsWritten) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  const auto show = [&](const std::string& log_folder) {
    Telemetry telemetry(scene, log_folder, *link_);
    cycle(true, 1.0);
    telemetry.drain();
    EXPECT_EQ(run({"--json"}), kExitDone);
    const YAML::Node log = YAML::Load(output_)["log"];
    EXPECT_EQ(run(), kExitDone) << "the arm goes on";
    return log;
  };
  EXPECT_FALSE(show("").IsDefined());
  EXPECT_EQ(output_.find("\nlog "), std::string::npos) << output_;
  EXPECT_EQ(show(folder_.path())["state"].as<std::string>(), "writing");
  EXPECT_NE(output_.find("\nlog      writing; 1 file\n"), std::string::npos) << output_;
  scene.log.min_free_bytes = 1e15;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(show(folder_.path())["state"].as<std::string>(), "stopped");
  ::testing::internal::GetCapturedStderr();
  EXPECT_NE(output_.find("\nlog      stopped: " + folder_.path() + ": "), std::string::npos)
      << output_;
}

TEST_F(RunStatusFile, NoneWithoutAFolder) {
  EXPECT_TRUE(StatusFile().isDue());
  unsetenv("RUNTIME_DIRECTORY");
  EXPECT_FALSE(StatusFile().isDue());
}

}  // namespace
}  // namespace tactus
