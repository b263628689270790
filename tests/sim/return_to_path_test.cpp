#include <gtest/gtest.h>

#include <cmath>

#include "support/closed_loop.h"
#include "support/period.h"

/// How the arm gets back to its path when the obstacle that held it is gone.
namespace tactus {
namespace {

using test::ClosedLoop;
using test::kPeriod_s;
constexpr double kPathLength_m = 0.4436;

const char* variantName(Variant variant) {
  constexpr const char* kNames[] = {"none",      "null_space", "joint_space", "task_space",
                                    "null_task", "null_joint", "null_limit"};
  return kNames[static_cast<int>(variant)];
}

/// Scenario 2, of which both obstacles vanish at once.
PlantConfig vanishingObstacles(double vanishes_s) {
  PlantConfig plant = test::crops9Plant(test::scenario2());
  for (ObstacleConfig& obstacle : plant.obstacles) obstacle.vanishes_s = vanishes_s;
  return plant;
}

/// What happened to the tool in some time.
struct ToolRun {
  double fastest_m_per_s = 0.0;  ///< beyond the speed of the reference
  double largest_lag_m = 0.0;
  double peak_force_N = 0.0;
  int contacts = 0;  ///< how often the obstacle was met, having been left
};

ToolRun runTool(ClosedLoop& loop, double duration_s) {
  constexpr double kTouching_N = 1.2;
  constexpr double kLeft_N = 0.6;
  ToolRun run;
  bool is_touching = false;
  for (int i = 0; i < std::lround(duration_s / kPeriod_s); ++i) {
    const ControllerOutput before = loop.output();
    loop.step();
    const ControllerOutput& output = loop.output();
    run.largest_lag_m = std::max(run.largest_lag_m, output.error.norm());
    run.peak_force_N = std::max(run.peak_force_N, output.sensed[0].force_N);
    const bool was_touching = is_touching;
    is_touching = output.sensed[0].force_N > (was_touching ? kLeft_N : kTouching_N);
    run.contacts += is_touching && !was_touching;
    if (before.w.size() == 0) continue;
    const double speed_m_per_s = (output.w - before.w).norm() / kPeriod_s;
    run.fastest_m_per_s = std::max(run.fastest_m_per_s, speed_m_per_s - before.w_d_dot.norm());
  }
  return run;
}

class ReturnToPath : public testing::TestWithParam<Variant> {
 protected:
  /// The null space alone cannot bear the stiff profile for long.
  double vanishes_s() const { return GetParam() == Variant::kNullSpace ? 8.0 : 11.0; }

  ControllerConfig config() const { return test::crops9Controller(GetParam(), true); }
};

TEST_P(ReturnToPath, IsNoFasterThanItsKey) {
  for (const double cap_m_per_s : {0.25, 0.05}) {
    ControllerConfig capped = config();
    capped.gains.task.max_return_speed_m_per_s = cap_m_per_s;
    ClosedLoop loop(capped, vanishingObstacles(vanishes_s()), kPeriod_s);
    runTool(loop, vanishes_s());
    const ToolRun run = runTool(loop, 20.0);
    EXPECT_LE(run.fastest_m_per_s, 1.02 * cap_m_per_s);
    EXPECT_EQ(loop.output().fault, Fault::kNone);
    EXPECT_LT(loop.output().error.norm(), 1e-3) << "it does come back";
  }
}

TEST_P(ReturnToPath, WithoutTheKeyIsBetaTimesItsError) {
  ClosedLoop loop(config(), vanishingObstacles(vanishes_s()), kPeriod_s);
  const double lag_m = runTool(loop, vanishes_s()).largest_lag_m;
  const ToolRun run = runTool(loop, 20.0);
  if (GetParam() == Variant::kNullSpace) {
    EXPECT_LT(lag_m, 1e-3) << "the tool keeps its task";
    return;
  }
  EXPECT_GT(lag_m, 0.07);
  EXPECT_GT(run.fastest_m_per_s, 0.255) << "the cap would not be felt";
}

/// A cap of the correction alone would make the multi-space loop bounce off the stiff profile.
TEST_P(ReturnToPath, LeavesTheContactAsItIs) {
  const double duration_s = GetParam() == Variant::kNullSpace ? 8.0 : 15.0;
  ClosedLoop loop(config(), test::crops9Plant(test::scenario2()), kPeriod_s);
  const ToolRun free = runTool(loop, duration_s);
  ASSERT_GT(free.peak_force_N, 1.2);
  for (const double cap_m_per_s : {0.25, 0.1, 0.05}) {
    ControllerConfig capped = config();
    capped.gains.task.max_return_speed_m_per_s = cap_m_per_s;
    ClosedLoop capped_loop(capped, test::crops9Plant(test::scenario2()), kPeriod_s);
    const ToolRun run = runTool(capped_loop, duration_s);
    EXPECT_LE(run.peak_force_N, 1.01 * free.peak_force_N) << cap_m_per_s;
    EXPECT_LE(run.contacts, free.contacts) << cap_m_per_s;
    EXPECT_NEAR(capped_loop.output().sensed[0].force_N, loop.output().sensed[0].force_N, 0.05)
        << cap_m_per_s;
  }
}

TEST_P(ReturnToPath, CompletesAPathThatWaitedForIt) {
  constexpr double kWait_m = 0.02;
  ControllerConfig waiting = config();
  waiting.gains.task.wait_beyond_m = kWait_m;
  waiting.gains.task.max_return_speed_m_per_s = 0.25;
  ClosedLoop loop(waiting, vanishingObstacles(vanishes_s()), kPeriod_s);
  loop.step();
  const double start_m = loop.output().w_d[1];
  const ToolRun held = runTool(loop, vanishes_s());
  const ControllerOutput at_loss = loop.output();
  if (GetParam() != Variant::kNullSpace) {
    EXPECT_GT(held.largest_lag_m, kWait_m);
    EXPECT_LT(at_loss.w_d_dot.norm(), 0.2 * 0.0537) << "it stands, or nearly so";
    EXPECT_LT(at_loss.path_time_s, 0.95 * vanishes_s());
  }
  // Beyond that only as far as the law itself pushes the tool away.
  EXPECT_LT(held.largest_lag_m, 2.2 * kWait_m);
  runTool(loop, 40.0);  // task space goes back slowly at first
  EXPECT_GT(loop.output().path_time_s - at_loss.path_time_s, 20.0) << "it waits no longer";
  EXPECT_NEAR(loop.output().w_d[1] - start_m, kPathLength_m, 1e-9);
  EXPECT_LT(loop.output().error.norm(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Variants, ReturnToPath,
                         testing::Values(Variant::kNullSpace, Variant::kJointSpace,
                                         Variant::kTaskSpace, Variant::kNullTask,
                                         Variant::kNullJoint, Variant::kNullLimit),
                         [](const auto& test) { return variantName(test.param); });

}  // namespace
}  // namespace tactus
