#include "tactus/analysis/cover_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "support/crops9.h"
#include "support/random.h"
#include "tactus/sim/simulated_robot.h"

/// Against the simulated module and arm.
namespace tactus {
namespace {

struct CoverRun {
  CoverConfig cover;
  double noise_N = 0.0;
  double sway_rad = 0.2;  ///< of all joints
  double duration_s = 12.0;
  double touch_N = 0.0;                  ///< from the middle of the run on
  double first_s = 0.0;                  ///< of the log
  double lost_s = 0.0;                   ///< of each second of it
  std::vector<double> drifts_N_per_s{};  ///< of the channels
};

CoverEstimate fitRun(const CoverRun& run) {
  ControllerConfig config = test::crops9Controller(Variant::kNone);
  config.gravity_Base = Vector3(0.0, 0.0, -9.81);
  PlantConfig plant = test::crops9Plant({});
  plant.gravity_Base = config.gravity_Base;
  plant.modules[0].cover = run.cover;
  plant.modules[0].noise_N = run.noise_N;
  plant.modules[0].channel_drifts_N_per_s = run.drifts_N_per_s;
  SimulatedRobot robot(config, plant, 0.001);
  CoverFit fit(config, config.tactile_modules.front());
  RobotInput input;
  for (int cycle = 0; cycle < 1000.0 * run.duration_s; ++cycle) {
    robot.read(input);
    const double t_s = 0.001 * cycle;
    if (t_s > 0.5 * run.duration_s) input.tactile[0].force_z_N += run.touch_N;
    const bool is_lost = t_s < run.first_s || std::fmod(t_s, 1.0) < run.lost_s;
    if (is_lost) fit.skip(0.001);
    if (!is_lost) fit.add(input.q_measured, input.tactile[0], 0.001);
    JointVector velocity(9);
    for (int i = 0; i < 9; ++i)
      velocity[i] = i == 0 ? 0.0 : run.sway_rad * (0.6 + 0.1 * i) * std::sin((0.6 + 0.1 * i) * t_s);
    robot.write(velocity);
  }
  return fit.estimate();
}

TEST(CoverFit, FindsMassAndCenterWithinItsOwnDeviation) {
  test::Random random(931);
  for (int i = 0; i < 6; ++i) {
    CoverRun run;
    run.cover = {random.uniform(0.1, 1.0), random.vector<Vector3>(3, -0.03, 0.03)};
    run.cover.p_ModuleCenter.x() += 0.19;
    run.noise_N = 0.05;
    const CoverEstimate estimate = fitRun(run);
    EXPECT_NEAR(estimate.mass_kg.value, run.cover.mass_kg, 6.0 * estimate.mass_kg.deviation + 1e-4);
    EXPECT_LT(estimate.mass_kg.deviation, 0.01);
    for (int axis = 0; axis < 3; ++axis) {
      const Fitted& center = estimate.center_m[axis];
      EXPECT_NEAR(center.value, run.cover.p_ModuleCenter[axis], 6.0 * center.deviation + 1e-4);
      EXPECT_LT(center.deviation, 0.02);
    }
    EXPECT_NEAR(estimate.residual_N, 0.08, 0.05) << "that of two or four cells' noise";
  }
}

/// A part of a sway that does not come to an end goes with time, as drift does.
TEST(CoverFit, ChannelsThatDriftAreNoCover) {
  test::Random random(932);
  for (int i = 0; i < 4; ++i) {
    CoverRun run{.cover = {0.3, Vector3(0.2, 0.01, -0.02)}, .noise_N = 0.01};
    for (int k = 0; k < 8; ++k) run.drifts_N_per_s.push_back(random.uniform(-0.02, 0.02));
    const CoverEstimate estimate = fitRun(run);
    EXPECT_NEAR(estimate.mass_kg.value, 0.3, 6.0 * estimate.mass_kg.deviation + 1e-4);
    EXPECT_LT(estimate.mass_kg.deviation, 0.005);
    const double least = std::abs(run.drifts_N_per_s[0] - run.drifts_N_per_s[1] +
                                  run.drifts_N_per_s[4] - run.drifts_N_per_s[5]);
    EXPECT_GT(estimate.drift_N_per_s, 0.9 * least) << "of F_y";
    for (int axis = 0; axis < 3; ++axis) {
      const Fitted& center = estimate.center_m[axis];
      EXPECT_NEAR(center.value, run.cover.p_ModuleCenter[axis], 6.0 * center.deviation + 1e-4);
      EXPECT_LT(center.deviation, 0.01);
    }
  }
}

TEST(CoverFit, WithoutNoiseItIsExactButForTheArmsOwnTurning) {
  const CoverRun run{.cover = {0.4, Vector3(0.2, 0.01, -0.02)}};
  const CoverEstimate estimate = fitRun(run);
  EXPECT_NEAR(estimate.mass_kg.value, 0.4, 1e-3);
  EXPECT_LT(
      (Vector3(estimate.center_m[0].value, estimate.center_m[1].value, estimate.center_m[2].value) -
       run.cover.p_ModuleCenter)
          .norm(),
      1e-3);
  EXPECT_LT(estimate.residual_N, 0.005);
}

/// As the last part of a long log, and as one whose disk was too slow.
TEST(CoverFit, BearsALogThatBeginsInMotionAndOneWithGaps) {
  for (const auto& [first_s, lost_s] : {std::pair{1.3, 0.0}, std::pair{0.0, 0.1}}) {
    const CoverRun run{
        .cover = {0.4, Vector3(0.2, 0.01, -0.02)}, .first_s = first_s, .lost_s = lost_s};
    const CoverEstimate estimate = fitRun(run);
    EXPECT_NEAR(estimate.mass_kg.value, 0.4, 2e-3);
    EXPECT_NEAR(estimate.center_m[0].value, 0.2, 2e-3);
    EXPECT_LT(estimate.residual_N, 0.01);
  }
}

/// Time goes on while records are missing, and drift with it.
TEST(CoverFit, ChannelsDriftInGapsToo) {
  CoverRun run{.cover = {0.4, Vector3(0.2, 0.01, -0.02)}, .lost_s = 0.6};
  run.drifts_N_per_s = {0.04, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const CoverEstimate estimate = fitRun(run);
  EXPECT_NEAR(estimate.mass_kg.value, 0.4, 2e-3);
  EXPECT_NEAR(estimate.drift_N_per_s, 0.04, 0.004);
}

TEST(CoverFit, SaysThatAnArmHardlyTurned) {
  const CoverEstimate still = fitRun({.cover = {0.4, Vector3(0.2, 0.0, 0.0)}, .sway_rad = 0.002});
  EXPECT_LT(still.change_across, 0.1);
  EXPECT_LT(still.change_along, 0.1);
  const CoverEstimate moved = fitRun({.cover = {0.4, Vector3(0.2, 0.0, 0.0)}});
  EXPECT_GT(moved.change_across, 0.3);
  EXPECT_GT(moved.change_along, 0.3);
}

TEST(CoverFit, AContactShowsInTheDeviationAndInWhatIsLeft) {
  const CoverConfig cover{0.4, Vector3(0.2, 0.0, 0.0)};
  const CoverEstimate alone = fitRun({.cover = cover, .noise_N = 0.05});
  const CoverEstimate touched = fitRun({.cover = cover, .noise_N = 0.05, .touch_N = 3.0});
  EXPECT_GT(touched.residual_N, 2.0 * alone.residual_N);
  EXPECT_GT(touched.mass_kg.deviation, 4.0 * alone.mass_kg.deviation);
}

/// From half a newton on, where the deviation does not tell yet.
TEST(CoverFit, AContactShowsInTheDrift) {
  const CoverConfig cover{0.4, Vector3(0.2, 0.0, 0.0)};
  EXPECT_LT(fitRun({.cover = cover, .noise_N = 0.2}).drift_N_per_s, 0.01);
  for (const double touch_N : {0.5, -1.0, 3.0, 10.0})
    EXPECT_GT(fitRun({.cover = cover, .noise_N = 0.05, .touch_N = touch_N}).drift_N_per_s, 0.03);
}

TEST(CoverFit, ALastPartIsASecondFromHalfOfOneOn) {
  const auto blocksOf = [](double duration_s) {
    return fitRun({.cover = {0.4, Vector3(0.2, 0.0, 0.0)}, .duration_s = duration_s}).blocks;
  };
  EXPECT_EQ(blocksOf(4.01), 4);
  EXPECT_EQ(blocksOf(4.4), 4);
  EXPECT_EQ(blocksOf(4.6), 5);
  EXPECT_EQ(blocksOf(5.0), 5);
  EXPECT_EQ(blocksOf(5.01), 5);
}

TEST(CoverFit, OfTooShortARunItSaysNothing) {
  const CoverEstimate estimate =
      fitRun({.cover = {0.4, Vector3(0.2, 0.0, 0.0)}, .duration_s = 2.0});
  EXPECT_LT(estimate.blocks, CoverFit::kMinBlocks);
  EXPECT_EQ(estimate.mass_kg.value, 0.0);
}

}  // namespace
}  // namespace tactus
