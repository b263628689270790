#include "tactus/supervisor/cycle_record.h"

#include <gtest/gtest.h>

#include "support/telemetry.h"

namespace tactus {
namespace {

/// Every number of a cycle is another one, so that a mix-up shows.
struct NumberedCycle {
  RobotInput input;
  Gains gains;
  ControllerOutput output;
  Vector3 tool_error{0.91, 0.92, 0.93};

  NumberedCycle() {
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
    output.modules_lost = 2;
    output.speed_share = 0.375;
    output.fault = Fault::kTactileStale;
  }
};

TEST(FillRecord, PutsEveryNumberInItsColumn) {
  const NumberedCycle cycle;
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
  EXPECT_EQ(record.modules_lost, 2u);
  EXPECT_EQ(record.speed_share, 0.375);
  EXPECT_TRUE(isSame(record.gains, cycle.gains));
}

TEST(RecordedInput, IsTheInputThatWasRecorded) {
  const NumberedCycle cycle;
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

/// Samples of all modules that a robot may have, also of those that this one has not.
TEST(RecordedInput, HasEveryModule) {
  CycleRecord record;
  for (int i = 0; i < kMaxTactileModules; ++i) {
    record.tactile_moment_x_Nm[i] = 0.5 + i;
    record.tactile_sequence[i] = 10 + static_cast<std::uint64_t>(i);
  }
  const RobotInput input = recordedInput(record, 2);
  EXPECT_EQ(input.q_measured, JointVector(JointVector::Zero(2)));
  for (int i = 0; i < kMaxTactileModules; ++i) {
    EXPECT_EQ(input.tactile[i].moment_x_Nm, 0.5 + i);
    EXPECT_EQ(input.tactile[i].sequence, 10u + static_cast<unsigned>(i));
  }
}

TEST(FillRecord, LeavesWhatTheRobotHasNot) {
  const NumberedCycle cycle;
  CycleRecord record;
  record.q[3] = record.dq[3] = record.q_measured[3] = 77.0;
  record.w[2] = record.wd[2] = record.wd_dot[2] = 77.0;
  record.force_sensor_N[2] = 77.0;
  fillRecord(0.5, cycle.input, cycle.gains, cycle.output, cycle.tool_error, record);
  for (const double kept : {record.q[3], record.dq[3], record.q_measured[3], record.w[2],
                            record.wd[2], record.wd_dot[2], record.force_sensor_N[2]})
    EXPECT_EQ(kept, 77.0);
}

TEST(LargestForce, IsThatOfTheModuleWhichFeelsMost) {
  CycleRecord record;
  EXPECT_EQ(largestForce_N(record, 0), 0.0);
  record.force_sensor_N[0] = 1.0;
  record.force_sensor_N[1] = 3.0;
  record.force_sensor_N[2] = 2.0;
  EXPECT_EQ(largestForce_N(record, 1), 1.0);
  EXPECT_EQ(largestForce_N(record, 2), 3.0);
  EXPECT_EQ(largestForce_N(record, 3), 3.0);
}

}  // namespace
}  // namespace tactus
