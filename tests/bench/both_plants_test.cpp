#include <gtest/gtest.h>

#include "tactus/bench/physics_grid.h"

namespace tactus::physics {
namespace {

const std::string kScenes = std::string(TACTUS_SOURCE_DIR) + "/config/scenes";
constexpr double kCoarse_s = 0.00025;  ///< of MuJoCo, for the sake of time

struct Sample {
  Case one;
  double duration_s;
};

void PrintTo(const Sample& sample, std::ostream* stream) {
  *stream << sample.one.scene << ' ' << gearsName(sample.one.gears);
}

class ClosedLoopOfBothPlants : public testing::TestWithParam<Sample> {};

/// A few of what `tactus bench --physics` compares.
TEST_P(ClosedLoopOfBothPlants, PeaksAndRestsAlike) {
  Scene scene = sceneOf(GetParam().one, kScenes);
  scene.duration_s = GetParam().duration_s;
  const Trial expected = tryOut(scene, Plant::kMujoco, kCoarse_s);
  const Trial trial = tryOut(scene, Plant::kBuiltIn);
  ASSERT_EQ(expected.fault, Fault::kNone);
  ASSERT_EQ(trial.fault, Fault::kNone);
  ASSERT_GT(expected.peak_N, 1.0) << "nothing was touched";
  EXPECT_NEAR(trial.peak_N, expected.peak_N, 0.08 * expected.peak_N);
  EXPECT_NEAR(trial.rest_N, expected.rest_N, 0.08 * expected.peak_N);
  EXPECT_NEAR(trial.tool_error_m, expected.tool_error_m, 0.01);
}

INSTANTIATE_TEST_SUITE_P(
    Contacts, ClosedLoopOfBothPlants,
    testing::Values(Sample{{"scenario3_tactus", Gears::kRigid, 0.0, 0.0}, 8.0},
                    Sample{{"scenario3_estimated", Gears::kFlexible, 0.0, 0.0}, 9.0},
                    Sample{{"scenario3_tactus", Gears::kBare, 1e5, 0.0}, 7.0},
                    Sample{{"scenario3_tactus", Gears::kFlexible, 1e6, 0.0}, 7.0},
                    Sample{{"scenario1_null_space", Gears::kRigid, 0.0, 0.3}, 9.0},
                    Sample{{"scenario3_estimated", Gears::kFlexible, 300.0, 0.6}, 9.0}));

/// The same comparison tells an arm without mass from one with mass.
TEST(ClosedLoopOfBothPlants, AreNotAlikeWithoutMass) {
  const Case one{"scenario3_tactus", Gears::kBare, 1e6, 0.0};
  Scene scene = sceneOf(one, kScenes);
  Scene quasi_static = quasiStaticSceneOf(one, kScenes);
  scene.duration_s = quasi_static.duration_s = 6.5;
  EXPECT_LT(tryOut(scene, Plant::kMujoco, kCoarse_s).peak_N,
            0.8 * tryOut(quasi_static, Plant::kBuiltIn).peak_N);
}

}  // namespace
}  // namespace tactus::physics
