#include "tactus/supervisor/cycle_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "support/telemetry.h"
#include "tactus/record/record_fields.h"

namespace tactus {
namespace {

TEST(RecordFields, NameEveryWordOfARecordButItsGainsExactlyOnceInItsOrder) {
  std::vector<std::size_t> offsets;
  for (const RecordColumn& column :
       recordColumns({kMaxJoints, kMaxTaskSize, true, kMaxTactileModules, true, true}))
    offsets.push_back(column.offset);
  std::ranges::sort(offsets);
  ASSERT_EQ(offsets.size() * 8, offsetof(CycleRecord, gains));
  for (std::size_t i = 0; i < offsets.size(); ++i) EXPECT_EQ(offsets[i], 8 * i);
  const auto of_one_module = recordColumns({kMaxJoints, kMaxTaskSize, true, 1, true, true});
  EXPECT_TRUE(std::ranges::is_sorted(of_one_module, {}, &RecordColumn::offset));
}

TEST(RecordFields, OfFurtherModulesComeLast) {
  const auto one = recordColumns({9, 3}), two = recordColumns({9, 3, false, 2});
  ASSERT_EQ(two.size(), one.size() + 10);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(two[i].name, one[i].name);
  EXPECT_EQ(two[one.size()].name, "force_sensor_N_2");
  EXPECT_EQ(two.back().name, "tactile_sequence_2");
}

TEST(RecordFields, NamesAreUniqueAndAllowedInUlog) {
  std::map<std::string, int> count;
  for (const RecordField& field : recordFields()) {
    const std::string name = field.name;
    EXPECT_EQ(++count[name], 1) << name;
    EXPECT_TRUE(std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) || c == '_';
    })) << name;
  }
}

TEST(RecordFields, ColumnsBeginAsTheContractSays) {
  const std::vector<std::string> expected = {"t_s",
                                             "force_sensor_N",
                                             "contact_position_m",
                                             "contact_dir_x",
                                             "contact_dir_y",
                                             "contact_dir_z",
                                             "force_contact_N",
                                             "stiffness_N_per_m",
                                             "stiffness_raw_N_per_m",
                                             "gamma",
                                             "k_n",
                                             "k_j",
                                             "k_t",
                                             "x_dot_eff_m_per_s",
                                             "u_n",
                                             "u_j",
                                             "u_t",
                                             "q_1",
                                             "q_2",
                                             "q_3",
                                             "q_4",
                                             "q_5",
                                             "q_6",
                                             "q_7",
                                             "q_8",
                                             "q_9",
                                             "dq_1",
                                             "dq_2",
                                             "dq_3",
                                             "dq_4",
                                             "dq_5",
                                             "dq_6",
                                             "dq_7",
                                             "dq_8",
                                             "dq_9",
                                             "w_1",
                                             "w_2",
                                             "w_3",
                                             "wd_1",
                                             "wd_2",
                                             "wd_3",
                                             "wd_dot_1",
                                             "wd_dot_2",
                                             "wd_dot_3",
                                             "fault",
                                             "wake_latency_ns",
                                             "step_ns"};
  const auto columns = recordColumns({9, 3});
  ASSERT_GE(columns.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(columns[i].name, expected[i]);
}

TEST(RecordFields, OnlyClocksFaultAndToolErrorAreNoConcernOfTheController) {
  for (const RecordField& field : recordFields()) {
    const std::string name = field.name;
    const bool observed = name.ends_with("_ns") || name.starts_with("tool_") ||
                          name == "fault";  // the loop knows more faults than the controller
    const bool input = name == "t_s" || name == "task_time_s" || name == "mode" ||
                       name == "missed_cycles" || name == "q_measured" ||
                       name.starts_with("tactile_");
    EXPECT_EQ(field.role, observed ? FieldRole::kObservation
                          : input  ? FieldRole::kInput
                                   : FieldRole::kOutput)
        << name;
  }
}

TEST(RecordFields, RunsJoinOnlyWhereBothSidesContinue) {
  std::vector<CopyRun> runs;
  appendRun({0, 10, 8}, runs);
  appendRun({8, 18, 16}, runs);
  appendRun({24, 42, 8}, runs);  // gap in the message
  appendRun({40, 50, 8}, runs);  // gap in the record
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].size, 24u);
}

/// Every number of a cycle is another one, so that a mix-up shows.
struct Cycle {
  RobotInput input;
  Gains gains;
  ControllerOutput output;
  Vector3 tool_error{0.91, 0.92, 0.93};

  Cycle() {
    input.q_measured = JointVector::LinSpaced(3, 1.1, 1.3);
    gains.force.damping = 9.1;
    input.tactile[0] = {2.1, 2.2, 2.3, 2.4, 4000000000u, 2.5};
    output.velocity = JointVector::LinSpaced(3, 3.1, 3.3);
    output.q_desired = JointVector::LinSpaced(3, 4.1, 4.3);
    output.w = TaskVector::LinSpaced(2, 5.1, 5.2);
    output.w_d = TaskVector::LinSpaced(2, 6.1, 6.2);
    output.w_d_dot = TaskVector::LinSpaced(2, 7.1, 7.2);
    output.modules = 2;
    output.sensed[0] = {8.01, 8.02, {8.03, 8.04, 8.05}};
    output.sensed[1] = {8.21, 8.22, {8.23, 8.24, 8.25}};
    input.tactile[1] = {2.6, 2.7, 2.8, 2.9, 17};
    output.contact = {.force_contact_N = 8.06,
                      .stiffness_N_per_m = 8.07,
                      .stiffness_raw_N_per_m = 8.08,
                      .gamma = 8.09,
                      .k_n = 8.10,
                      .k_j = 8.11,
                      .k_t = 8.12,
                      .x_dot_eff_m_per_s = 8.13,
                      .u_n = 8.14,
                      .u_j = 8.15,
                      .u_t = 8.16};
    output.path_time_s = 0.25;
    output.fault = Fault::kTactileStale;
  }
};

TEST(FillRecord, PutsEveryNumberInItsColumn) {
  const Cycle cycle;
  CycleRecord record;
  record.step_ns = -5;
  record.wake_latency_ns = 6;
  record.read_ns = 7;
  record.write_ns = 8;
  record.missed_cycles = 9;
  fillRecord(0.5, cycle.input, cycle.gains, cycle.output, cycle.tool_error, record);
  const std::vector<double> expected = {
      0.5,  8.01, 8.02, 8.03, 8.04, 8.05, 8.06, 8.07, 8.08, 8.09, 8.10, 8.11, 8.12, 8.13, 8.14,
      8.15, 8.16, 4.1,  4.2,  4.3,  3.1,  3.2,  3.3,  5.1,  5.2,  6.1,  6.2,  7.1,  7.2,  2,
      6,    -5,   1.1,  1.2,  1.3,  2.1,  2.2,  2.3,  2.4,  4e9,  0.91, 0.92, 0.93, 0.5,  3,
      7,    8,    9,    0.25, 8.21, 8.22, 8.23, 8.24, 8.25, 2.6,  2.7,  2.8,  2.9,  17};
  const RecordShape shape{3, 2, false, 2};
  const auto columns = recordColumns(shape);
  const auto words = test::loggedWords(record, shape);
  ASSERT_EQ(words.size(), expected.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    double number;
    std::memcpy(&number, &words[i], 8);
    if (columns[i].type == FieldType::kInt64) {
      number = static_cast<double>(static_cast<std::int64_t>(words[i]));
    }
    if (columns[i].type == FieldType::kUint64) number = static_cast<double>(words[i]);
    EXPECT_NEAR(number, expected[i], 1e-14) << columns[i].name;
  }
  EXPECT_TRUE(isSame(record.gains, cycle.gains));
}

TEST(RecordedInput, IsTheInputThatWasRecorded) {
  const Cycle cycle;
  CycleRecord record;
  fillRecord(0.5, cycle.input, cycle.gains, cycle.output, cycle.tool_error, record);
  const RobotInput input = recordedInput(record, 3);
  EXPECT_EQ(input.q_measured, cycle.input.q_measured);
  EXPECT_EQ(input.tactile[0].force_y_N, 2.1);
  EXPECT_EQ(input.tactile[0].force_z_N, 2.2);
  EXPECT_EQ(input.tactile[0].moment_y_Nm, 2.3);
  EXPECT_EQ(input.tactile[0].moment_z_Nm, 2.4);
  EXPECT_EQ(input.tactile[0].sequence, 4000000000u);
  EXPECT_EQ(input.tactile[0].moment_x_Nm, 2.5);
  EXPECT_EQ(input.tactile[1].force_y_N, 2.6);
  EXPECT_EQ(input.tactile[1].sequence, 17u);
  EXPECT_EQ(input.tactile[2].sequence, 0u);
}

}  // namespace
}  // namespace tactus
