#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tactus/bench/extremes_study.h"
#include "tactus/bench/state_numbers.h"
#include "tactus/bench/study.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

const std::string kExtremesBase =
    std::string(TACTUS_SOURCE_DIR) + "/config/scenes/base/crops9_contact.yaml";

ExtremeLaw lawNamed(const std::string& name) {
  const auto& laws = extremeLaws();
  return *std::ranges::find(laws, name, &ExtremeLaw::name);
}

ExtremeCase caseNamed(const std::string& name) {
  const std::vector<ExtremeCase> cases = extremeCases();
  const auto found = std::ranges::find(cases, name, &ExtremeCase::name);
  if (found == cases.end()) throw std::out_of_range("no case " + name);
  return *found;
}

ExtremeRun runNamed(const std::string& name, const std::string& law) {
  return runExtreme(kExtremesBase, caseNamed(name), lawNamed(law));
}

/// The middle one of each group, but for those that take long.
std::vector<ExtremeCase> selection() {
  std::map<std::string, std::vector<ExtremeCase>> groups;
  for (const ExtremeCase& extreme : extremeCases())
    if (!extreme.is_long) groups[extreme.group].push_back(extreme);
  std::vector<ExtremeCase> chosen;
  for (const auto& [group, cases] : groups) chosen.push_back(cases[cases.size() / 2]);
  return chosen;
}

TEST(Extremes, AreBoundedFiniteAndWithinLimits) {
  const std::vector<ExtremeRow> rows = runExtremes(
      kExtremesBase, selection(), {lawNamed("estimated"), lawNamed("joint_space")}, 1.0);
  EXPECT_GE(rows.size(), 20u);
  for (const ExtremeRow& row : rows) {
    SCOPED_TRACE(row.extreme.group + ": " + row.extreme.name + ", " + row.law.name);
    EXPECT_EQ(row.run.not_finite_cycles, 0);
    EXPECT_EQ(row.run.beyond_limits_cycles, 0);
    EXPECT_EQ(row.run.subnormal_cycles, 0);
    EXPECT_NE(row.run.outcome, "NOT BOUNDED");
    EXPECT_NE(row.run.outcome, "command_not_finite");
    EXPECT_EQ(row.run.refused_at_load, "");
  }
}

TEST(Extremes, HaveAnOutcomeThatIsTold) {
  EXPECT_EQ(runNamed("profile behind foam, speed x 1", "assumed").outcome, "at rest");
  const ExtremeRun invalid = runNamed("no number", "assumed");
  EXPECT_EQ(invalid.outcome, "tactile_invalid");
  EXPECT_LT(invalid.cycles, 14000) << "over as soon as the arm is at rest";
  EXPECT_EQ(runNamed("100 % of samples lost, 60 N/m band", "assumed").outcome, "tactile_stale");
  const ExtremeRun cycle = runNamed("stiffness.assumed_N_per_m = 10", "assumed");
  EXPECT_NE(cycle.outcome, "at rest");
  EXPECT_NE(cycle.refused_by_check, "");
  const ExtremeRun refused = runNamed("task.drift_gain_per_s = 1001", "assumed");
  EXPECT_EQ(refused.outcome, "refused at load");
  EXPECT_EQ(refused.refused_at_load, "task.drift_gain_per_s");
  EXPECT_EQ(refused.cycles, 0);
}

TEST(Extremes, HaveNamesOfTheirOwnAndLawsThatDiffer) {
  std::set<std::string> names, laws;
  for (const ExtremeCase& extreme : extremeCases())
    EXPECT_TRUE(names.insert(extreme.group + extreme.name).second) << extreme.name;
  for (const ExtremeLaw& law : extremeLaws()) EXPECT_TRUE(laws.insert(law.name).second);
  EXPECT_GT(names.size(), 250u);
}

TEST(Extremes, AreSummedUpByGroupAndLaw) {
  ExtremeRow row{{"sensor", "noisy"}, {"assumed", {}}, {}};
  row.run.outcome = "at rest";
  row.run.peak_force_N = 5.0;
  std::vector<ExtremeRow> rows(3, row);
  rows[1].run.outcome = "limit cycle";
  rows[1].run.peak_force_N = 9.0;
  rows[2].run.outcome = "NOT BOUNDED";
  rows[2].run.beyond_limits_cycles = 1;
  const Table summary = extremeSummary(rows);
  ASSERT_EQ(summary.rows.size(), 1u);
  EXPECT_EQ(summary.number(0, "rows"), 3.0);
  EXPECT_EQ(summary.number(0, "at_rest"), 1.0);
  EXPECT_EQ(summary.number(0, "limit_cycle"), 1.0);
  EXPECT_EQ(summary.number(0, "restless_though_accepted"), 1.0);
  EXPECT_EQ(summary.number(0, "not_bounded"), 1.0);
  EXPECT_EQ(summary.number(0, "peak_force_N"), 9.0);
  EXPECT_EQ(extremeTable(rows).word(2, "outcome"), "NOT BOUNDED");
}

TEST(Extremes, WatchEveryNumberOfTheState) {
  ControllerState state;
  state.q_desired = state.velocity_before = JointVector::Zero(9);
  state.contact.law.It_m_per_s = 7.0;
  state.contact.joint_space_transition.contact.direction.z() = 8.0;
  int count = 0;
  std::set<std::string> names;
  std::map<double, std::string> found;
  visitNumbers(state, [&](const char* name, int index, double value) {
    EXPECT_TRUE(names.insert(name + std::to_string(index)).second) << name;
    found[value] = name;
    ++count;
  });
  EXPECT_EQ(count, 9 + 9 + 2 * kMaxJoints + 4 + 2 + 5 + 5 + 5 + 1 + 4 + 5 + 5 + 5 +
                       (30 + 7 * kMaxJoints + 5 + 2) + 2 + (1 + 2 * 3 + 4 * 5) + 1 +
                       (5 + 5 + 3 + 2 + 2 * kMaxJoints + 7) + 1);
  EXPECT_EQ(found[7.0], "law.It");
  EXPECT_EQ(found[8.0], "joint_space.direction");
}

/// It swings as it does without noise.
TEST(Extremes, DoNotTakeALimitCycleForNoise) {
  ExtremeCase extreme = caseNamed("stiffness.assumed_N_per_m = 10");
  EXPECT_EQ(runExtreme(kExtremesBase, extreme, lawNamed("assumed")).outcome, "limit cycle");
  extreme.overrides.push_back({"simulation.tactile_module.noise_N", "1e-6"});
  EXPECT_EQ(runExtreme(kExtremesBase, extreme, lawNamed("assumed")).outcome, "limit cycle");
}

/// What a long run is judged by, in a minute of one.
TEST(Extremes, OfLongRunsTellWhatBecomesOfTheState) {
  ExtremeCase extreme = caseNamed("half an hour on a 60 N/m band, no noise");
  const ExtremeRun run = runExtreme(kExtremesBase, extreme, lawNamed("assumed"), 1.0 / 60.0);
  const auto force = std::ranges::find(run.state, "force_N[0]", &StateNumber::name);
  ASSERT_NE(force, run.state.end());
  EXPECT_GT(force->early_largest, 1.0) << "in contact after six seconds";
  EXPECT_LT(force->early_largest, force->late_mean) << "and pressed on still";
  EXPECT_GT(force->late_mean, 4.9);
  EXPECT_GE(force->late_largest, force->late_mean);
}

TEST(Extremes, DoNotHideABrokenBaseInTheTable) {
  EXPECT_EQ(runExtreme("gone.yaml", caseNamed("no number"), lawNamed("assumed")).outcome,
            "refused at load");
  BenchOptions options;
  options.scenes = {"gone.yaml"};
  EXPECT_THROW(studyStability(options), InputError);
}

}  // namespace
}  // namespace tactus
