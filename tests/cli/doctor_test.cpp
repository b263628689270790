#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/allocation_guard.h"
#include "support/command_run.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/cli/doctor_report.h"
#include "tactus/cli/scene_step.h"
#include "tactus/record/ulog_writer.h"

namespace tactus {
namespace {

LoopMeasurement someMeasurement() {
  LoopMeasurement measured;
  measured.period_s = 0.001;
  measured.cycles = 2;
  measured.wake_latency.add(3'000);
  measured.wake_latency.add(30);
  measured.step.add(7'000);
  measured.step.add(7'000);
  return measured;
}

const std::vector<Finding> kFindings = {{"kernel", Level::kOk, "6.1, PREEMPT_RT"},
                                        {"disk", Level::kWarning, "\"full\"", "why", "how"}};

TEST(DoctorReport, JsonHoldsFindingsFiguresAndDistributions) {
  const std::string json = jsonText(doctorJson(kFindings, someMeasurement()));
  for (const char* part :
       {"\"fit\": true", "\"name\": \"kernel\"", "\"level\": \"warning\"", R"("what": "\"full\"")",
        "\"why_it_matters\": \"why\"", "\"how_to_mend\": \"how\"", "\"cycles\": 2", "\"max\": 3000",
        "\"up_to_ns\": 30,\n        \"count\": 1", "\"up_to_ns\": 7167,\n        \"count\": 2"})
    EXPECT_NE(json.find(part), std::string::npos) << part << " in\n" << json;
}

TEST(DoctorReport, TextSaysTheVerdictLast) {
  const std::string text = doctorText(kFindings, someMeasurement());
  EXPECT_TRUE(text.ends_with("\nfit: 0 to mend, 1 warning\n")) << text;
  EXPECT_NE(text.find("warning  disk             \"full\"\n"), std::string::npos) << text;
  EXPECT_NE(text.find(" why: why\n"), std::string::npos) << text;
  EXPECT_NE(text.find("4.10                   1         0\n"), std::string::npos) << text;
  std::vector<Finding> worse = kFindings;
  worse.push_back({"kernel", Level::kNotFit, "x", "why", "how"});
  EXPECT_TRUE(doctorText(worse, someMeasurement()).ends_with("NOT FIT: 1 to mend, 1 warning\n"));
  EXPECT_NE(jsonText(doctorJson(worse, someMeasurement())).find("\"fit\": false"),
            std::string::npos);
}

/// Of a loop that ran for no time nothing is known.
TEST(Doctor, DurationsThatAreNoneAreRefused) {
  for (const char* const word : {"nan", "-nan", "0", "-1", "inf", "2e6"}) {
    std::string output;
    EXPECT_THROW(
        test::runCommand(addDoctorCommand, {"doctor", std::string("--duration=") + word}, output),
        CLI::ValidationError)
        << word;
  }
}

TEST(DoctorReport, ARunWithoutACycleIsReportedToo) {
  EXPECT_NE(doctorText({}, {}).find("0 cycles"), std::string::npos);
}

TEST(SceneStep, GoesOnBeyondTheSceneWithoutHeap) {
  const Scene scene =
      test::shippedScene("scenario1_null_space", {parseOverride("simulation.duration_s=0.02")});
  SceneStep step(scene);
  const test::AllocationGuard guard;
  for (int i = 0; i < 100; ++i) step.run();
}

TEST(UlogWriter, GrowsByAsMuchACycleAsItSays) {
  const Scene scene = test::shippedScene("scenario1_null_space");
  const LogDescription description = describeLog(scene);
  const auto sizeOfLog = [&](int cycles) {
    const test::TemporaryFile file;
    UlogWriter writer(file.path(), description);
    for (int i = 0; i < cycles; ++i) writer.write(CycleRecord{});
    writer.close();
    return std::filesystem::file_size(file.path());
  };
  EXPECT_EQ(sizeOfLog(1) - sizeOfLog(0),
            logBytesOfSides(description) + logBytesACycle(description.shape));
  EXPECT_EQ(sizeOfLog(8) - sizeOfLog(1), 7 * logBytesACycle(description.shape));
}

}  // namespace
}  // namespace tactus
