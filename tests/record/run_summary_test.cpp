#include "tactus/record/run_summary.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "support/crops9.h"
#include "support/telemetry.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

ControllerConfig config() { return test::crops9Controller(Variant::kNullSpace); }

CycleRecord restingRecord(double t_s) {
  CycleRecord record;
  record.t_s = t_s;
  return record;
}

TEST(RunSummary, OfNoCycleIsZero) {
  const RunFigures figures = RunSummary(config(), 10).figures();
  EXPECT_EQ(figures.cycles, 0);
  EXPECT_EQ(figures.tcp_error_rms_m, 0.0);
  EXPECT_EQ(figures.step_time_ns->max, 0);
}

TEST(RunSummary, FindsPeaksAndFinalValues) {
  RunSummary summary(config(), 4);
  CycleRecord record = restingRecord(0.0);
  const double forces[] = {1.0, 6.0, 6.0, 2.0};
  const double stiffnesses[] = {100.0, 200.0, 300.0, 400.0};
  const double errors[] = {0.0, 0.03, 0.0, 0.04};
  for (int i = 0; i < 4; ++i) {
    record.force_sensor_N[0] = forces[i];
    record.stiffness_N_per_m = stiffnesses[i];
    record.tool_error_m[0] = -0.6 * errors[i];
    record.tool_error_m[2] = 0.8 * errors[i];
    record.dq[0] = 0.1 * i;
    record.dq[8] = -0.2;
    summary.add(record);
  }
  const RunFigures figures = summary.figures();
  EXPECT_EQ(figures.cycles, 4);
  EXPECT_EQ(figures.peak_force_N, 6.0);
  EXPECT_EQ(figures.stiffness_at_peak_N_per_m, 200.0);
  EXPECT_EQ(figures.final_force_N, 2.0);
  EXPECT_EQ(figures.stiffness_final_N_per_m, 400.0);
  EXPECT_NEAR(figures.tcp_error_max_m, 0.04, 1e-15);
  EXPECT_NEAR(figures.tcp_error_final_m, 0.04, 1e-15);
  EXPECT_NEAR(figures.tcp_error_rms_m, 0.025, 1e-15);
  EXPECT_NEAR(figures.peak_joint_speed_squared, 0.3 * 0.3 + 0.04, 1e-15);
}

TEST(RunSummary, HasARotationErrorOnlyOfATaskWithOne) {
  ControllerConfig c = config();
  EXPECT_FALSE(RunSummary(c, 0).figures().tcp_rotation_error);
  c.task.components[2] = 4;
  RunSummary summary(c, 0);
  for (const double error_rad : {0.0, 0.4, 0.3}) {
    CycleRecord record;
    record.tool_rotation_error_rad = error_rad;
    summary.add(record);
  }
  const RunFigures figures = summary.figures();
  ASSERT_TRUE(figures.tcp_rotation_error);
  EXPECT_EQ(figures.tcp_rotation_error->max_rad, 0.4);
  EXPECT_EQ(figures.tcp_rotation_error->final_rad, 0.3);
  EXPECT_NEAR(figures.tcp_rotation_error->rms_rad, std::sqrt(0.25 / 3.0), 1e-15);
}

TEST(RunSummary, CountsCyclesWithAJointOnItsLimitOnce) {
  const ControllerConfig c = config();
  RunSummary summary(c, 4);
  CycleRecord record;
  summary.add(record);
  record.q[0] = c.limits.upper[0] - 2e-4;
  summary.add(record);
  EXPECT_EQ(summary.figures().joints_at_limit_cycles, 0);
  record.q[0] = c.limits.upper[0] - 1e-6;
  record.q[3] = c.limits.lower[3];
  summary.add(record);
  record.q[0] = 0.0;
  summary.add(record);
  EXPECT_EQ(summary.figures().joints_at_limit_cycles, 2);
}

TEST(RunSummary, IgnoresWhatAShorterRobotDoesNotHave) {
  RunSummary summary(config(), 1);
  CycleRecord record;
  record.dq[9] = 1e9;
  record.q[9] = 1e9;
  summary.add(record);
  EXPECT_EQ(summary.figures().peak_joint_speed_squared, 0.0);
  EXPECT_EQ(summary.figures().joints_at_limit_cycles, 0);
}

TEST(RunSummary, StepTimesAreOrderStatistics) {
  RunSummary summary(config(), 10);
  CycleRecord record;
  for (int i = 0; i < 200; ++i) {
    record.step_ns = (i * 77) % 200 + 1;  // 1 to 200, shuffled
    summary.add(record);
  }
  const auto step = *summary.figures().step_time_ns;
  EXPECT_EQ(step.min, 1);
  EXPECT_NEAR(static_cast<double>(step.median), 103.0, 3.0);
  EXPECT_NEAR(static_cast<double>(step.p99), 199.0, 1.0);
  EXPECT_EQ(step.max, 200);
}

Scene scene() {
  return {.name = "a \"b\"\n\x01\\\xff",
          .controller = config(),
          .variant = "null_space",
          .plant = {},
          .robot_name = {},
          .joint_names = {},
          .module_links = {"link4"},
          .sources = {},
          .overrides = {},
          .numbers = {}};
}

TEST(SummaryJson, HasTheKeysOfTheContractInTheirOrder) {
  RunFigures figures;
  figures.step_time_ns.emplace();
  const YAML::Node json = YAML::Load(jsonText(summaryJson(scene(), figures, 512.5)));
  const std::vector<std::string> expected = {"scene",
                                             "variant",
                                             "stages",
                                             "cycles",
                                             "peak_force_N",
                                             "final_force_N",
                                             "tcp_error_max_m",
                                             "tcp_error_rms_m",
                                             "tcp_error_final_m",
                                             "peak_joint_speed_squared",
                                             "joints_at_limit_cycles",
                                             "stiffness_final_N_per_m",
                                             "stiffness_at_peak_N_per_m",
                                             "contacts",
                                             "step_time_ns",
                                             "real_time_factor",
                                             "outcome",
                                             "fault"};
  std::vector<std::string> keys;
  for (const auto& entry : json) keys.push_back(entry.first.as<std::string>());
  EXPECT_EQ(keys, expected);
  EXPECT_EQ(json["real_time_factor"].as<double>(), 512.5);
  EXPECT_EQ(json["outcome"].as<std::string>(), "completed");
  EXPECT_TRUE(json["fault"].IsNull());
}

TEST(SummaryJson, HoldsTheRotationErrorOfATaskWithOne) {
  RunFigures figures;
  figures.tcp_rotation_error = {0.25, 0.125, 0.5};
  const YAML::Node json = YAML::Load(jsonText(summaryJson(scene(), figures, 1.0)));
  EXPECT_EQ(json["tcp_rotation_error_max_rad"].as<double>(), 0.25);
  EXPECT_EQ(json["tcp_rotation_error_rms_rad"].as<double>(), 0.125);
  EXPECT_EQ(json["tcp_rotation_error_final_rad"].as<double>(), 0.5);
}

TEST(SummaryJson, KeepsNumbersToTheBitAndNamesTheFault) {
  RunFigures figures;
  figures.cycles = 13000;
  figures.peak_force_N = 0.1 + 0.2;
  figures.tcp_error_max_m = std::numeric_limits<double>::denorm_min();
  figures.tcp_error_final_m = std::numeric_limits<double>::quiet_NaN();
  ContactFigures contact;
  static_cast<ContactSummary&>(contact) = {1.0, 2.5, 1.0 / 3.0, 0.25};
  figures.contacts = {contact};
  figures.end.fault = Fault::kTactileStale;
  figures.end.detail = {0.021, 0.02, "s"};
  const std::string text = jsonText(summaryJson(scene(), figures, 1.0));
  const YAML::Node json = YAML::Load(text);
  EXPECT_EQ(json["cycles"].as<long long>(), 13000);
  EXPECT_EQ(json["peak_force_N"].as<double>(), 0.1 + 0.2);
  EXPECT_NE(text.find("\"tcp_error_max_m\": 5e-324"), std::string::npos);
  EXPECT_TRUE(json["tcp_error_final_m"].IsNull());
  EXPECT_EQ(json["contacts"][0]["peak_force_N"].as<double>(), 1.0 / 3.0);
  EXPECT_EQ(json["contacts"][0]["tactile_module"].as<std::string>(), "link4");
  EXPECT_EQ(json["outcome"].as<std::string>(), "tactile_stale");
  EXPECT_EQ(json["fault"]["value"].as<double>(), 0.021);
}

/// However long a run is: what is behind the ten thousandth is counted.
TEST(RunSummary, BoundsItsContacts) {
  ControllerConfig config = scene().controller;
  RunSummary summary(config, 0);
  CycleRecord record;
  constexpr int kContacts = 10007, kCyclesEach = 10;
  for (int i = 0; i < kContacts * kCyclesEach; ++i) {
    record.t_s = 0.05 * i;
    record.force_sensor_N[0] = i % kCyclesEach < 3 ? 5.0 : 0.0;
    record.force_contact_N = record.force_sensor_N[0];
    summary.add(record);
  }
  RunFigures figures = summary.figures();
  EXPECT_EQ(figures.contacts.size(), 10000u);
  EXPECT_EQ(figures.further_contacts, kContacts - 10000);
  EXPECT_NEAR(figures.contacts[9999].start_s, 0.05 * 9999 * kCyclesEach, 1e-6);
  EXPECT_EQ(summaryJson(scene(), figures, 1.0).at("further_contacts"), kContacts - 10000);
  figures.further_contacts = 0;
  EXPECT_FALSE(summaryJson(scene(), figures, 1.0).contains("further_contacts"));
}

TEST(SummaryJson, EscapesWhateverASceneIsCalled) {
  const std::string text = jsonText(summaryJson(scene(), RunFigures(), 1.0));
  EXPECT_NE(text.find("\"scene\": \"a \\\"b\\\"\\n\\u0001\\\\\xef\xbf\xbd\""), std::string::npos)
      << text;
}

TEST(WriteSummary, ReportsAFullDisk) {
  EXPECT_THROW(writeSummary("/dev/full", scene(), RunFigures(), 1.0), RunError);
  EXPECT_THROW(writeSummary("/nowhere/summary.json", scene(), RunFigures(), 1.0), InputError);
}

}  // namespace
}  // namespace tactus
