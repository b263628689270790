#include <gtest/gtest.h>

#include <complex>

#include "support/rail_robot.h"

/// The acceleration level on an ideal plant (no filter, no lag, linear spring) against the closed
/// form of docs/acceleration_level.md.
namespace tactus {
namespace {

constexpr double kEulerStep_s = 1e-5;
constexpr double kTarget_s = 0.1;          // T
constexpr double kTargetDamping = 0.5;     // d
constexpr double kTaken_N_per_m = 7000.0;  // c
constexpr double kPressed_N = 10.0;        // at the start
constexpr double kNearby_N = 0.02;         // of Euler steps of kEulerStep_s / T = 1e-4

/// x'' + b x' + k x = 0 from x0 at rest.
double decayed(double b, double k, double x0, double t_s) {
  const std::complex<double> root = std::sqrt(std::complex<double>(b * b / 4.0 - k));
  const std::complex<double> s1 = -b / 2.0 + root, s2 = -b / 2.0 - root;
  return (x0 * (s1 * std::exp(s2 * t_s) - s2 * std::exp(s1 * t_s)) / (s1 - s2)).real();
}

ControllerConfig accelerationRail(Variant variant) {
  ControllerConfig config = test::railController(variant);
  config.force_control->level = ControlLevel::kAcceleration;
  return config;
}

/// Runs from kPressed_N at rest until check(t_s, F_N, u_t before) returns false.
template <typename Check>
void runAccelerationLoop(const ControllerConfig& config, double stiffness_N_per_m, Check check) {
  const test::RailWorld world{stiffness_N_per_m, -kPressed_N / stiffness_N_per_m};
  const Controller controller(config);
  ControllerState state = controller.initialState();
  state.velocity_before[1] =  // the tool is on its way, the contact rests
      Trajectory(config.task.trajectory, {}).evaluate(0.0).v_BaseTool.y();
  ControllerOutput output;
  for (int cycle = 0; cycle * kEulerStep_s < 2.0; ++cycle) {
    const double t_s = cycle * kEulerStep_s;
    if (!check(t_s, world.force_N(state.q_desired), output.contact.u_t)) return;
    controller.update(world.input(state), controller.initialGains(), t_s, kEulerStep_s, state,
                      output);
    ASSERT_EQ(output.fault, Fault::kNone);
  }
}

/// The damping is the target's whatever the stiffness: F'' = -2 d / T F' - c_e / (c T^2) F.
void expectTarget(const ControllerConfig& config, double ratio) {
  int cycles = 0;
  runAccelerationLoop(config, ratio * kTaken_N_per_m, [&](double t_s, double F_N, double) {
    const double expected =
        decayed(2.0 * kTargetDamping / kTarget_s, ratio / (kTarget_s * kTarget_s), kPressed_N, t_s);
    if (expected < kNearby_N) return false;
    EXPECT_NEAR(F_N, expected, kNearby_N) << "at " << t_s << " s, c_e/c " << ratio;
    ++cycles;
    return !testing::Test::HasFailure();
  });
  EXPECT_GT(cycles, 1000);
}

class AccelerationTarget : public testing::TestWithParam<double> {};

TEST_P(AccelerationTarget, IsThatOfASpringWithTheTargetsDamping) {
  expectTarget(accelerationRail(Variant::kNullSpace), GetParam());
}

TEST_P(AccelerationTarget, IsTheSameForEveryWeight) {
  ControllerConfig config = accelerationRail(Variant::kNullSpace);
  config.weights << 4.0, 0.25;
  expectTarget(config, GetParam());
}

TEST_P(AccelerationTarget, IsTheSameWhileTheTaskMovesTowardsTheObstacle) {
  ControllerConfig config = accelerationRail(Variant::kNullSpace);
  Waypoint line;
  line.displacement_m = Vector3(0.0, 10.0, 0.0);
  config.task.trajectory = {-1.0, {line}};
  expectTarget(config, GetParam());
}

INSTANTIATE_TEST_SUITE_P(StiffnessRatios, AccelerationTarget, testing::Values(0.25, 1.0, 2.0, 9.0));

TEST(AccelerationTargetOfTwoSpaces, IsTheSumOfBothWhileBothGiveWay) {
  const ControllerConfig config = accelerationRail(Variant::kNullTask);
  const double act_N = config.gains.force.activation_force_N;
  // F'' = -4 d / T F' - 2 / T^2 F + F_act / T^2: about F_act / 2.
  int cycles = 0;
  runAccelerationLoop(config, kTaken_N_per_m, [&](double t_s, double F_N, double u_t_before) {
    // k_v eases the end of the tool's share.
    if (++cycles > 3000 && u_t_before > -2e-3) return false;
    const double expected =
        0.5 * act_N + decayed(4.0 * kTargetDamping / kTarget_s, 2.0 / (kTarget_s * kTarget_s),
                              kPressed_N - 0.5 * act_N, t_s);
    EXPECT_NEAR(F_N, expected, kNearby_N) << t_s;
    return !testing::Test::HasFailure();
  });
  EXPECT_GT(cycles, 5000);
}

/// The null space is used up: it has joints that do not give way.
TEST(AccelerationTargetOfTwoSpaces, ComesToRestAtTheActivationForce) {
  ControllerConfig config = accelerationRail(Variant::kNullTask);
  config.gains.force.max_null_speed_m_per_s = 1e-12;
  config.gains.task.drift_gain_per_s = 5.0;
  double last_N = 0.0;
  runAccelerationLoop(config, kTaken_N_per_m, [&](double, double F_N, double) {
    last_N = F_N;
    return true;
  });
  EXPECT_NEAR(last_N, config.gains.force.activation_force_N, 0.01)
      << "no integral, and beta pulls the tool back";
}

TEST(AccelerationTargetOfTwoSpaces, LeavesTheToolAloneBelowTheActivationForce) {
  ControllerConfig config = accelerationRail(Variant::kNullTask);
  config.gains.force.activation_force_N = kPressed_N + 0.1;
  const test::RailWorld world{kTaken_N_per_m, -kPressed_N / kTaken_N_per_m};
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int cycle = 0; cycle < 20000; ++cycle) {
    controller.update(world.input(state), controller.initialGains(), 0.0, kEulerStep_s, state,
                      output);
    ASSERT_NEAR(output.error[0], 0.0, 1e-12) << cycle;
  }
}

}  // namespace
}  // namespace tactus
