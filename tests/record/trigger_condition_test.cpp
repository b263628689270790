#include "tactus/record/trigger_condition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/random.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

constexpr RecordShape kOneModule{.joints = 3, .task_size = 2};
constexpr RecordShape kThreeModules{.joints = 3, .task_size = 2, .modules = 3};

CycleRecord numberedRecord() {
  CycleRecord record;
  for (int i = 0; i < kMaxTactileModules; ++i) record.force_sensor_N[i] = 10.0 + i;
  for (int i = 0; i < kMaxJoints; ++i) record.q[i] = 20.0 + i;
  record.u_n = -3.5;
  record.missed_cycles = 7;
  return record;
}

double signalIn(const std::string& text, const RecordShape& shape) {
  return signalOf(parseTrigger(text, shape), numberedRecord());
}

std::string triggerError(const std::string& text, const RecordShape& shape = kOneModule) {
  try {
    parseTrigger(text, shape);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TriggerCondition, TakesFieldsByTheNamesOfLogAndCsv) {
  EXPECT_EQ(signalIn("force_N[0] > 1.2", kOneModule), 10.0);
  EXPECT_EQ(signalIn("force_sensor_N>1.2", kOneModule), 10.0);
  EXPECT_EQ(signalIn("  q[2]  <=  -1e-3 ", kOneModule), 22.0);
  EXPECT_EQ(signalIn("q_3 <= 0", kOneModule), 22.0);
  EXPECT_EQ(signalIn("u_n < 0", kOneModule), -3.5);
  EXPECT_EQ(signalIn("missed_cycles >= 1", kOneModule), 7.0);
  EXPECT_EQ(signalIn("force_N[ 2 ] > 0", kThreeModules), 12.0);
  EXPECT_EQ(signalIn("force_sensor_N_2 > 0", kThreeModules), 11.0);
}

TEST(TriggerCondition, OfAnyModuleIsTheOneThatComesFirst) {
  EXPECT_EQ(signalIn("force_N > 1", kThreeModules), 12.0);
  EXPECT_EQ(signalIn("force_N >= 1", kThreeModules), 12.0);
  EXPECT_EQ(signalIn("force_N < 1", kThreeModules), 10.0);
  CycleRecord record = numberedRecord();
  record.force_sensor_N[1] = std::nan("");
  EXPECT_TRUE(std::isnan(signalOf(parseTrigger("force_N > 1", kThreeModules), record)));
}

TEST(TriggerCondition, KnowsComparisonLevelAndUnit) {
  const TriggerCondition condition = parseTrigger("x_dot_eff_m_per_s <= -2.5e-2", kOneModule);
  EXPECT_EQ(condition.comparison, Comparison::kAtMost);
  EXPECT_EQ(condition.level, -0.025);
  EXPECT_EQ(condition.unit, "m/s");
  EXPECT_FALSE(condition.isRising());
  EXPECT_TRUE(parseTrigger("force_N > 1", kOneModule).isOfForce());
}

TEST(TriggerCondition, SaysWhereItIsWrong) {
  EXPECT_EQ(triggerError("forse_N[0] > 1"),
            "--trigger:1:1: 'forse_N[0] > 1': 'forse_N' is no field of the log, perhaps force_N");
  EXPECT_EQ(triggerError("q[7] > 1"), "--trigger:1:3: 'q[7] > 1': no index of q, expected 0 to 2");
  EXPECT_EQ(triggerError("q > 1"),
            "--trigger:1:1: 'q > 1': q is a list of 3, expected one of them, as q[0]");
  EXPECT_EQ(triggerError("u_n[0] > 1"),
            "--trigger:1:5: 'u_n[0] > 1': u_n is no list, expected no index");
  EXPECT_EQ(triggerError("q[0 > 1"), "--trigger:1:5: 'q[0 > 1': found '> 1', expected ]");
  EXPECT_EQ(triggerError("u_n = 1"),
            "--trigger:1:5: 'u_n = 1': found '= 1', expected one of > >= < <=");
  EXPECT_EQ(triggerError("u_n >"), "--trigger:1:6: 'u_n >': nothing is left, expected a number");
  EXPECT_EQ(triggerError("u_n > 1 N"), "--trigger:1:9: 'u_n > 1 N': found 'N', expected the end");
  for (const std::string number : {"inf", "nan", "-inf", "1e999"})
    EXPECT_EQ(triggerError("u_n > " + number),
              "--trigger:1:7: 'u_n > " + number + "': found '" + number + "', expected a number");
  EXPECT_NE(triggerError("").find(":1:1:"), std::string::npos);
  EXPECT_NE(triggerError("tactile_moment_x_Nm > 1").find("no field"), std::string::npos);
  EXPECT_NE(triggerError("q[-1] > 1").find("expected 0 to 2"), std::string::npos);
  EXPECT_NE(triggerError("q[99999999999999999999] > 1").find("no index"), std::string::npos);
  EXPECT_NE(triggerError(std::string(1000, '[')).find("too long"), std::string::npos);
}

/// Whatever is typed ends in a condition or in one line.
TEST(TriggerCondition, OfAnyTextIsAConditionOrOneLine) {
  const std::string alphabet = "q[0]>=<1.2e- uforce_N\n\x1b\xff";
  test::Random random(1);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (int n = random.integer(0, 12); n > 0; --n)
      text += alphabet[static_cast<std::size_t>(random.index(static_cast<int>(alphabet.size())))];
    const std::string error = triggerError(text);
    accepted += error == "accepted" ? 1 : 0;
    for (const char c : error) ASSERT_GE(static_cast<unsigned char>(c), 0x20u) << error;
  }
  EXPECT_LT(accepted, 100);
}

TEST(TriggerCondition, TakesEveryColumnOfTheCsv) {
  for (const RecordColumn& column : recordColumns(kThreeModules))
    EXPECT_EQ(triggerError(column.name + " > 0", kThreeModules), "accepted");
}

}  // namespace
}  // namespace tactus
