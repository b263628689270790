#include "tactus/sim/moving_cover.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/closed_loop.h"
#include "support/random.h"

namespace tactus {
namespace {

const Vector3 kGravity(0.0, 0.0, -9.81);

TEST(MovingCover, FeelsWeightByItsPosture) {
  const CoverConfig cover{0.4, Vector3(0.19, 0.0, 0.0)};
  // Level, its z up: the weight pulls along -z and turns about +y.
  const MovingCover level(cover, kGravity, Pose{});
  EXPECT_LT((level.atRest() - Wrench5{{0.0, -3.924, 0.19 * 3.924, 0.0, 0.0}}).norm(), 1e-12);
  const Pose upright{Eigen::AngleAxisd(-0.5 * 3.14159265358979, Vector3::UnitY()).matrix(), {}};
  EXPECT_LT(MovingCover(cover, kGravity, upright).atRest().norm(), 1e-9) << "not felt along x";
}

TEST(MovingCover, FeelsItsInertiaAsItTurnsAndIsPushed) {
  const CoverConfig cover{0.7, Vector3(0.2, 0.03, -0.05)};
  test::Random random(911);
  for (int i = 0; i < 20; ++i) {
    const Vector3 axis = random.unitVector();
    const Vector3 a = random.vector<Vector3>(3, -3.0, 3.0);
    const double omega = random.uniform(-4.0, 4.0);
    const double step_s = 1e-4;
    const auto poseAt = [&](double t_s) {
      return Pose{Eigen::AngleAxisd(omega * t_s, axis).matrix(), 0.5 * t_s * t_s * a};
    };
    MovingCover moving(cover, kGravity, poseAt(-0.01));
    Wrench5 felt;
    for (int step = -99; step <= 1; ++step) felt = moving.update(poseAt(step * step_s), step_s);
    // The mean acceleration of the last two steps is that at t = 0: pushed, and centripetal.
    const Vector3 c = cover.p_ModuleCenter;
    const Vector3 a_center = a + omega * omega * axis.cross(axis.cross(c));
    const Vector3 F = cover.mass_kg * (kGravity - a_center);
    const Vector3 M = c.cross(F);
    EXPECT_LT((felt - Wrench5{{F.y(), F.z(), M.y(), M.z(), M.x()}}).norm(), 0.02) << i;
  }
}

/// The paper's third scene with the arm's speed taken from it by a cover of so much, and its
/// compensation.
double peakForce_N(double mass_kg, double compensated_kg, bool quantised = false) {
  ControllerConfig config = test::crops9Controller(Variant::kNullLimit, true);
  PlantConfig plant = test::crops9Plant(test::scenario3());
  config.gravity_Base = plant.gravity_Base = kGravity;
  plant.modules[0].quantised = quantised;
  const Vector3 center(0.2, 0.01, -0.02);
  if (mass_kg > 0.0) plant.modules[0].cover = CoverConfig{mass_kg, center};
  if (compensated_kg > 0.0) config.tactile_modules[0].cover = CoverConfig{compensated_kg, center};
  test::ClosedLoop loop(config, plant, 0.001);
  double peak_N = 0.0;
  for (int cycle = 0; cycle < 10000; ++cycle) {
    loop.step();
    peak_N = std::max(peak_N, loop.robot().trueForce_N());
  }
  return peak_N;
}

TEST(MovingCover, CompensatedItIsAsIfThereWereNone) {
  const double without = peakForce_N(0.0, 0.0);
  for (const double mass_kg : {0.05, 0.4, 1.0}) {
    EXPECT_NEAR(peakForce_N(mass_kg, mass_kg), without, 0.002 * without) << mass_kg;
    EXPECT_NEAR(peakForce_N(mass_kg, mass_kg, true), without, 0.002 * without) << mass_kg;
  }
  EXPECT_GT(std::abs(peakForce_N(1.0, 0.0) - without), 0.02 * without)
      << "a cover makes no difference: this test is blind";
}

}  // namespace
}  // namespace tactus
