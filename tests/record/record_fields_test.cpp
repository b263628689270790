#include "tactus/record/record_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "support/telemetry.h"
#include "tactus/supervisor/cycle_record.h"

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

}  // namespace
}  // namespace tactus
