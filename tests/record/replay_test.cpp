#include "tactus/record/replay.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/crops9.h"
#include "support/period.h"
#include "support/telemetry.h"
#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

using test::kPeriod_s;
const RecordShape kShape{9, 3};

/// A touch that comes and goes: what a controller is fed does not have to be a simulation.
RobotInput touch(int cycle) {
  RobotInput input;
  input.q_measured = test::crops9Controller().q_start;
  input.tactile[0].force_y_N = std::max(0.0, 6.0 * std::sin(0.004 * (cycle - 100)));
  input.tactile[0].moment_z_Nm = 0.2 * input.tactile[0].force_y_N;
  input.tactile[0].sequence = static_cast<std::uint32_t>(cycle / 4);
  return input;
}

std::vector<CycleRecord> record(const ControllerConfig& config, int cycles) {
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  std::vector<CycleRecord> records(static_cast<std::size_t>(cycles));
  for (int i = 0; i < cycles; ++i) {
    const RobotInput input = touch(i);
    controller.update(input, controller.initialGains(), i * kPeriod_s, kPeriod_s, state, output);
    fillRecord(i * kPeriod_s, input, controller.initialGains(), output, Vector3(0.1, 0.2, 0.3),
               records[i]);
    records[i].step_ns = i;
    records[i].wake_latency_ns = -i;
  }
  return records;
}

ReplayComparison compare(const ControllerConfig& config, const std::vector<CycleRecord>& records) {
  const Controller controller(config);
  Replayer replayer(controller, kShape.joints, kPeriod_s);
  ReplayComparison comparison(kShape);
  for (const CycleRecord& recorded : records) {
    comparison.add(recorded, replayer.replay(recorded));
  }
  return comparison;
}

TEST(Replay, OfEveryVariantIsEqualToTheBit) {
  for (const Variant variant : {Variant::kNullSpace, Variant::kJointSpace, Variant::kTaskSpace,
                                Variant::kNullTask, Variant::kNullJoint, Variant::kNullLimit}) {
    for (const bool estimated : {false, true}) {
      const ControllerConfig config = test::crops9Controller(variant, estimated);
      const auto records = record(config, 1500);
      ASSERT_GT(records[500].force_contact_N, 1.0);
      const ReplayComparison comparison = compare(config, records);
      EXPECT_EQ(comparison.cycles(), 1500);
      EXPECT_EQ(comparison.differingCycles(), 0);
      EXPECT_FALSE(comparison.first());
      EXPECT_TRUE(comparison.largest().empty());
    }
  }
}

TEST(Replay, ThroughALogIsEqualToTheBit) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullTask, true);
  LogDescription description;
  description.shape = kShape;
  const auto log = test::readLog(test::writeLog(description, record(config, 500)));
  ASSERT_EQ(log.records.size(), 500u);
  EXPECT_EQ(compare(config, log.records).differingCycles(), 0);
}

TEST(Replay, NoticesASingleBitOfAnyOutputAndOfNothingElse) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullTask, true);
  const auto records = record(config, 300);
  for (const RecordColumn& column : recordColumns(kShape)) {
    if (column.role == FieldRole::kInput) continue;
    auto changed = records;
    reinterpret_cast<char*>(&changed[123])[column.offset] ^= 1;
    const ReplayComparison comparison = compare(config, changed);
    if (column.role == FieldRole::kObservation) {
      EXPECT_EQ(comparison.differingCycles(), 0) << column.name;
      continue;
    }
    EXPECT_EQ(comparison.differingCycles(), 1) << column.name;
    ASSERT_TRUE(comparison.first()) << column.name;
    EXPECT_EQ(comparison.first()->column, column.name);
    EXPECT_EQ(comparison.first()->cycle, 123);
    EXPECT_EQ(comparison.first()->t_s, 123 * kPeriod_s);
  }
}

TEST(Replay, TellsNegativeFromPositiveZero) {
  ReplayComparison comparison(kShape);
  CycleRecord recorded, replayed;
  replayed.u_n = -0.0;
  comparison.add(recorded, replayed);
  ASSERT_TRUE(comparison.first());
  EXPECT_EQ(comparison.first()->column, "u_n");
}

TEST(Replay, AChangedInputChangesTheOutputs) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
  auto records = record(config, 600);
  records[400].tactile_force_y_N[0] += 1e-9;
  records[400].tactile_sequence[0] += 1000;
  const ReplayComparison comparison = compare(config, records);
  ASSERT_TRUE(comparison.first());
  EXPECT_EQ(comparison.first()->cycle, 400);
}

TEST(Replay, WithAnotherSettingFindsTheLargestDifferences) {
  ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
  const auto records = record(config, 1000);
  config.gains.force.time_constant_s = 0.2;
  const Controller controller(config);
  Replayer replayer(controller, kShape.joints, kPeriod_s);
  ReplayComparison comparison(kShape);
  double expected = 0.0;
  double expected_t_s = 0.0;
  for (CycleRecord recorded : records) {
    recorded.gains = config.gains;
    const CycleRecord replayed = replayer.replay(recorded);
    comparison.add(recorded, replayed);
    for (int i = 0; i < 9; ++i) {
      const double size = std::abs(recorded.dq[i] - replayed.dq[i]);
      if (size > expected) expected_t_s = recorded.t_s;
      expected = std::max(expected, size);
    }
  }
  EXPECT_GT(comparison.differingCycles(), 0);
  const auto largest = comparison.largest();
  ASSERT_EQ(largest.size(), 2u);  // dq and u_n: this variant has no u_j and no u_t
  EXPECT_EQ(largest[0].column.compare(0, 3, "dq_"), 0);
  EXPECT_EQ(largest[0].size(), expected);
  EXPECT_EQ(largest[0].t_s, expected_t_s);
  EXPECT_EQ(largest[1].column, "u_n");
}

/// A touch, nothing for long, a stop by the drives and on; the log's first part is missing.
TEST(Replay, OfALaterPartKnowsWhereTheArmWasTouchedAtLast) {
  constexpr int kFirst = 1500, kStop = 3600, kOn = 3700, kEnd = 4000;
  const Controller controller(test::crops9Controller(Variant::kNullLimit));
  ControllerState state = controller.initialState();
  ControllerOutput output;
  Replayer replayer(controller, kShape.joints, kPeriod_s);
  replayer.beginPart(1);
  ReplayComparison comparison(kShape);
  Mode before = Mode::kRunning;
  for (int i = 0; i < kEnd; ++i) {
    RobotInput input = touch(std::min(i, 1000));
    input.tactile[0].sequence = static_cast<std::uint32_t>(i / 4);
    const Mode mode = i >= kStop && i < kOn ? Mode::kFault : Mode::kRunning;
    applyMode(controller, mode, before, input, controller.initialGains(), state);
    before = mode;
    controller.update(input, controller.initialGains(), i * kPeriod_s, kPeriod_s, state, output);
    CycleRecord recorded;
    fillRecord(i * kPeriod_s, input, controller.initialGains(), output, Vector3::Zero(), recorded);
    recorded.task_time_s = recorded.path_time_s = i * kPeriod_s;
    recorded.mode = static_cast<std::uint64_t>(mode);
    if (i < kFirst) continue;
    const CycleRecord replayed = replayer.replay(recorded);
    if (replayer.isKnown()) comparison.add(recorded, replayed);
  }
  EXPECT_EQ(comparison.cycles(), kEnd - kStop);
  EXPECT_EQ(comparison.differingCycles(), 0);
}

TEST(ReplayCsv, PutsRecordedAndReplayedSideBySide) {
  const test::TemporaryFile file(".csv");
  ReplayCsv csv(file.path(), {2, 1});
  CycleRecord recorded, replayed;
  recorded.t_s = 0.5;
  recorded.dq[0] = 1.0;
  recorded.dq[1] = 2.0;
  replayed.dq[0] = 3.0;
  replayed.dq[1] = 4.0;
  recorded.u_t = 5.0;
  replayed.u_t = 6.0;
  csv.add(recorded, replayed);
  csv.close();
  EXPECT_EQ(file.content(),
            "t_s,dq_1_recorded,dq_2_recorded,dq_1_replayed,dq_2_replayed,"
            "force_contact_N_recorded,force_contact_N_replayed,stiffness_N_per_m_recorded,"
            "stiffness_N_per_m_replayed,gamma_recorded,gamma_replayed,x_dot_eff_m_per_s_recorded,"
            "x_dot_eff_m_per_s_replayed,u_n_recorded,u_n_replayed,u_j_recorded,u_j_replayed,"
            "u_t_recorded,u_t_replayed\n"
            "0.5,1,2,3,4,0,0,0,0,0,0,0,0,0,0,0,0,5,6\n");
}

}  // namespace
}  // namespace tactus
