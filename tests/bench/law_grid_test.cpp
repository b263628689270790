#include "tactus/bench/law_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/crops9.h"
#include "support/tactile_samples.h"
#include "tactus/bench/law_trials.h"
#include "tactus/control/contact_point.h"

namespace tactus {
namespace {

RunSetup base() {
  return {test::crops9Controller(Variant::kNullTask, true), test::crops9Plant(test::scenario2())};
}

TEST(LawGrid, HasEachCombinationOnce) {
  const std::vector<LawGridPoint> points = lawGridPoints(7000.0);
  EXPECT_EQ(points.size(), 240u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_FALSE(points[i].band_N_per_m == points[k].band_N_per_m &&
                   points[i].profile_N_per_m == points[k].profile_N_per_m &&
                   points[i].robot_stiffness_N_per_m == points[k].robot_stiffness_N_per_m &&
                   points[i].speed_factor == points[k].speed_factor);
    }
  }
}

TEST(LawGrid, APointChangesWhatItNamesOnly) {
  const RunSetup setup = lawGridSetup(base(), {0.0, 1e5, kNoLimit, 2.0}, GridLaw::kAssumed);
  ASSERT_EQ(setup.plant.obstacles.size(), 1u);
  EXPECT_EQ(setup.plant.obstacles[0].stiffness_N_per_m, 1e5);
  EXPECT_TRUE(setup.plant.obstacles[0].foam.empty());
  EXPECT_EQ(setup.plant.obstacles[0].x_m, base().plant.obstacles[1].x_m);
  EXPECT_EQ(setup.plant.robot_stiffness_N_per_m, kNoLimit);
  EXPECT_DOUBLE_EQ(setup.controller.task.trajectory.waypoints[0].speed_m_per_s, 2.0 * 0.0537);
  EXPECT_EQ(setup.controller.force_control->variant, Variant::kNullTask);
  EXPECT_FALSE(setup.controller.force_control->has_estimator);
  const RunSetup slow = lawGridSetup(base(), {60.0, 1e5, 7000.0, 0.5}, GridLaw::kLimited);
  EXPECT_EQ(slow.plant.obstacles[0].stiffness_N_per_m, 60.0);
  EXPECT_GT(slow.duration_s, 20.0) << "the motion alone takes 17 s";
  EXPECT_EQ(slow.controller.force_control->variant, Variant::kNullLimit);
  EXPECT_TRUE(slow.controller.force_control->has_estimator);
}

TEST(LawGrid, SeesTheTouchOfTheProfile) {
  // Nothing reacts, so the speed of touch is that of the task, and the scale follows from it.
  RunSetup setup = lawGridSetup(base(), {0.0, 3000.0, kNoLimit, 1.0}, GridLaw::kAssumed);
  setup.controller.gains.force.activation_force_N = 1e9;
  setup.controller.gains.force.max_null_speed_m_per_s = 1e-9;
  setup.controller.gains.force.max_null_speed_rad_per_s = 1e-9;
  setup.duration_s = 8.0;
  const JudgedRun run = judgeRun(setup);
  EXPECT_GT(run.touch_speed_m_per_s, 0.02);
  EXPECT_LT(run.touch_speed_m_per_s, 0.0537);
  EXPECT_EQ(run.touch_force_N, 0.0);
  setup.controller.gains.force.activation_force_N = 0.1;
  const double delay_s = 0.005 + 1.0 / (M_PI * 15.0) + 0.002;
  EXPECT_NEAR(feedbackDelay_s(setup.plant), delay_s, 1e-12);
  EXPECT_NEAR(naturalScale(setup, run), 1.2 + 3000.0 * run.touch_speed_m_per_s * delay_s, 1e-9);
}

TEST(LawGrid, JudgesRestByTheTrueForce) {
  const JudgedRun bouncing =
      judgeRun(lawGridSetup(base(), {0.0, 7000.0, kNoLimit, 5.0}, GridLaw::kAssumed));
  EXPECT_TRUE(bouncing.isRestless()) << "as stiff as assumed, but five times as fast";
  const JudgedRun quiet =
      judgeRun(lawGridSetup(base(), {0.0, 3000.0, 7000.0, 1.0}, GridLaw::kAssumed));
  EXPECT_FALSE(quiet.isRestless());
}

TEST(LawTrials, DisturbWhatTheyName) {
  const RunSetup undisturbed =
      lawGridSetup(base(), {30.0, 7000.0, kNoLimit, 1.0}, GridLaw::kLimited);
  const double band_m = undisturbed.plant.obstacles.front().y_m;
  std::set<std::string> names;
  for (const LawTrial& trial : lawDisturbances()) {
    RunSetup setup = undisturbed;
    trial.change(setup);
    EXPECT_TRUE(names.insert(trial.name).second) << trial.name;
    EXPECT_EQ(setup.plant.obstacles.front().y_m, band_m) << "the profile moves, not the band";
    if (!setup.reading) continue;
    TactileSample sample{30.0, 40.0, -0.3 * 40.0, 0.3 * 30.0, 1};
    setup.reading(sample);
    ContactPointState contact;
    locateContact(sample, test::moduleOfLength(0.38), contact);
    const bool is_shifted = trial.name.starts_with("contact point");
    EXPECT_NEAR(contact.force_N, is_shifted ? 50.0 : 20.0, 1e-12) << trial.name;
    EXPECT_NEAR(std::abs(contact.position_m - 0.3), is_shifted ? 0.02 : 0.0, 1e-12) << trial.name;
  }
  EXPECT_EQ(names.size(), 11u);
}

TEST(LawTrials, AProfileThatComesMovesEvenly) {
  RunSetup setup = lawGridSetup(base(), {0.0, 7000.0, kNoLimit, 1.0}, GridLaw::kLimited);
  const double y_m = setup.plant.obstacles.back().y_m;
  const std::vector<LawTrial> trials = lawDisturbances();
  std::ranges::find(trials, "profile comes at 5 mm/s", &LawTrial::name)->change(setup);
  const ObstacleConfig& profile = setup.plant.obstacles.back();
  for (const double t_s : {0.0, 7.0, 20.0}) {
    const double way_m =
        profile.swing.y_m * std::sin(2.0 * M_PI * profile.swing.frequency_hz * t_s);
    EXPECT_NEAR(profile.y_m + way_m, y_m - 0.005 * (t_s - 7.0), 1e-5) << t_s;
  }
}

/// Some of the 168 points that are soft: 7 kN/m at most, in series with the arm.
TEST(LawTrials, TheLimitBearsSoftProfilesThatComeOrGo) {
  const std::vector<LawTrial> trials = lawDisturbances();
  const auto rest = [&](const LawGridPoint& point, const std::string& trial, bool has_estimator) {
    RunSetup setup = lawGridSetup(base(), point, GridLaw::kLimited);
    setup.controller.force_control->has_estimator = has_estimator;
    std::ranges::find(trials, trial, &LawTrial::name)->change(setup);
    setup.duration_s += 3.0;
    return judgeRun(setup);
  };
  const LawGridPoint points[] = {{0.0, 3e3, 7e3, 0.5},  {0.0, 7e3, kNoLimit, 0.5},
                                 {0.0, 1e6, 7e3, 1.0},  {10.0, 17e3, 7e3, 0.5},
                                 {30.0, 1e5, 7e3, 5.0}, {60.0, 3e3, kNoLimit, 0.5}};
  for (const LawGridPoint& point : points) {
    const JudgedRun run = rest(point, "profile comes at 5 mm/s", true);
    EXPECT_LT(run.peak_at_rest_N, 7.5) << point.band_N_per_m << ", " << point.profile_N_per_m;
    EXPECT_FALSE(run.isRestless()) << point.band_N_per_m << ", " << point.profile_N_per_m;
    EXPECT_GT(run.final_force_N, 4.9) << "it does press";
    EXPECT_LT(rest(point, "profile goes at 5 mm/s", true).peak_at_rest_N, 5.1);
  }
  const JudgedRun assumed = rest(points[1], "profile comes at 5 mm/s", false);
  EXPECT_GT(assumed.final_force_N, 6.0) << "of 8.5 N by (3), 2.5 at most are known";
  EXPECT_LT(assumed.peak_at_rest_N, 7.5);
}

/// The corners of the grid, where it is hardest.
TEST(LawGrid, TheLimitPeaksNearTheNaturalScaleAndComesToRest) {
  std::vector<LawGridRow> rows;
  for (const LawGridPoint& point : lawGridPoints(7000.0)) {
    const bool is_corner = (point.band_N_per_m == 0.0 || point.band_N_per_m == 30.0) &&
                           (point.profile_N_per_m == 3e3 || point.profile_N_per_m >= 1e5) &&
                           (point.speed_factor == 0.5 || point.speed_factor == 5.0);
    if (is_corner) rows.push_back(runLawGridPoint(base(), point, [](RunSetup&) {}));
  }
  ASSERT_EQ(rows.size(), 24u);
  const LawGridFigures limited = lawGridFigures(rows, GridLaw::kLimited);
  EXPECT_EQ(limited.restless, 0);
  EXPECT_EQ(limited.faults, 0);
  EXPECT_GT(limited.final_min_N, 4.95);
  EXPECT_LT(limited.final_max_N, 5.02);
  EXPECT_LT(limited.peak_to_scale, 1.2);
  EXPECT_LT(limited.peak_to_assumed, 1.05);
  EXPECT_GT(lawGridFigures(rows, GridLaw::kAssumed).restless, 5);
  const Table table = lawGridTable(rows);
  ASSERT_EQ(table.rows.size(), 24u * kGridLaws);
  double peak_N = 0.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.word(i, "law") == "limited")
      peak_N = std::max(peak_N, table.number(i, "peak_force_N"));
  }
  EXPECT_EQ(peak_N, limited.peak_N);
  Table summary = emptyLawSummary("summary");
  addLawSummary("none", GridLaw::kLimited, rows, summary);
  EXPECT_EQ(findNumber(summary, "largest_peak_N", {{"law", "limited"}}), peak_N);
}

}  // namespace
}  // namespace tactus
