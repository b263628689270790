#include <gtest/gtest.h>

#include <complex>

#include "support/rail_robot.h"

/// The closed loop on an ideal plant (no filter, no lag, linear spring) against the closed form of
/// (8), (12) and (13).
namespace tactus {
namespace {

constexpr double kFinePeriod_s = 2e-5;
constexpr double kLawT_s = 0.1;
constexpr double kDamping = 0.5;
constexpr double kAssumed_N_per_m = 7000.0;
constexpr double kStart_N = 10.0;
constexpr double kTolerance_N = 0.02;  // of Euler steps of kFinePeriod_s / kLawT_s = 2e-4

/// Solution of x'' + b x' + k x = 0.
class SecondOrder {
 public:
  SecondOrder(double b, double k, double x0, double v0) {
    const std::complex<double> root = std::sqrt(std::complex<double>(b * b / 4.0 - k));
    s1_ = -b / 2.0 + root;
    s2_ = -b / 2.0 - root;
    A_ = (v0 - s2_ * x0) / (s1_ - s2_);
    B_ = x0 - A_;
  }
  double at(double t_s) const {
    return (A_ * std::exp(s1_ * t_s) + B_ * std::exp(s2_ * t_s)).real();
  }

 private:
  std::complex<double> s1_, s2_, A_, B_;
};

/// Runs the loop from a force of kStart_N at rest until check(t_s, F_N) returns false.
template <typename Check>
void runLoop(const ControllerConfig& config, double stiffness_N_per_m, Check check) {
  const test::RailWorld world{stiffness_N_per_m, -kStart_N / stiffness_N_per_m};
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int cycle = 0; cycle * kFinePeriod_s < 1.0; ++cycle) {
    const double t_s = cycle * kFinePeriod_s;
    if (!check(t_s, world.force_N(state.q_desired))) return;
    controller.update(world.input(state), controller.initialGains(), t_s, kFinePeriod_s, state,
                      output);
    ASSERT_EQ(output.fault, Fault::kNone);
  }
}

class TargetDynamics : public testing::TestWithParam<std::tuple<Variant, double>> {
 protected:
  double ratio() const { return std::get<1>(GetParam()); }  // c_e / c

  /// The force must follow the closed form until it first reaches zero.
  void expectForce(const ControllerConfig& config, const SecondOrder& expected) {
    int cycles = 0;
    runLoop(config, ratio() * kAssumed_N_per_m, [&](double t_s, double F_N) {
      if (expected.at(t_s) < kTolerance_N) return false;
      EXPECT_NEAR(F_N, expected.at(t_s), kTolerance_N) << "at " << t_s << " s";
      ++cycles;
      return !testing::Test::HasFailure();
    });
    EXPECT_GT(cycles, 1000);
  }
};

TEST_P(TargetDynamics, SecondOrderFollowsEquation12) {
  const ControllerConfig config = test::railController(std::get<0>(GetParam()));
  // (13): T_eff = T sqrt(c / c_e), d_eff = d sqrt(c_e / c)
  const double T_eff_s = kLawT_s / std::sqrt(ratio());
  const double d_eff = kDamping * std::sqrt(ratio());
  expectForce(config, SecondOrder(2.0 * d_eff / T_eff_s, 1.0 / (T_eff_s * T_eff_s), kStart_N,
                                  -2.0 * d_eff / T_eff_s * kStart_N));
}

TEST_P(TargetDynamics, FirstOrderDecaysWithItsTimeConstant) {
  ControllerConfig config = test::railController(std::get<0>(GetParam()));
  config.force_control->order = 1;
  runLoop(config, ratio() * kAssumed_N_per_m, [&](double t_s, double F_N) {
    EXPECT_NEAR(F_N, kStart_N * std::exp(-ratio() * t_s / kLawT_s), kTolerance_N) << t_s;
    return t_s < 0.3 && !testing::Test::HasFailure();
  });
}

TEST_P(TargetDynamics, FeedforwardTakesTheTasksMotionOutOfTheContact) {
  // The task drives the tool towards the obstacle, half of it with the first carriage.
  ControllerConfig config = test::railController(std::get<0>(GetParam()));
  Waypoint line;
  line.displacement_m = Vector3(0.0, 10.0, 0.0);
  config.task.trajectory = {-1.0, {line}};  // in full motion at the start
  const double r = ratio();
  expectForce(config, SecondOrder(2.0 * kDamping * r / kLawT_s, r / (kLawT_s * kLawT_s), kStart_N,
                                  -2.0 * kDamping * r / kLawT_s * kStart_N));
}

INSTANTIATE_TEST_SUITE_P(SpacesAndStiffnessRatios, TargetDynamics,
                         testing::Combine(testing::Values(Variant::kNullSpace, Variant::kJointSpace,
                                                          Variant::kTaskSpace),
                                          testing::Values(0.25, 1.0, 2.0, 9.0)));

TEST(TargetDynamicsOfTwoSpaces, FollowCaseCOfEquation8) {
  for (const Variant variant : {Variant::kNullTask, Variant::kNullJoint}) {
    const ControllerConfig config = test::railController(variant);
    const double act_N = config.gains.force.activation_force_N;
    // F'' = -4 d / T F' - 2 / T^2 F + F_act / T^2: about F_act / 2.
    const SecondOrder expected(4.0 * kDamping / kLawT_s, 2.0 / (kLawT_s * kLawT_s),
                               kStart_N - 0.5 * act_N,
                               -2.0 * kDamping / kLawT_s * (kStart_N + (kStart_N - act_N)));
    int cycles = 0;
    runLoop(config, kAssumed_N_per_m, [&](double t_s, double F_N) {
      EXPECT_NEAR(F_N, expected.at(t_s) + 0.5 * act_N, kTolerance_N) << t_s;
      ++cycles;
      return F_N > act_N && !testing::Test::HasFailure();
    });
    EXPECT_GT(cycles, 500);
  }
}

TEST(TargetDynamicsOfWeights, DoNotChangeTheForce) {
  // W only decides who moves: along the force the dynamics is always the target's.
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.weights << 4.0, 0.25;
  const SecondOrder expected(2.0 * kDamping / kLawT_s, 1.0 / (kLawT_s * kLawT_s), kStart_N,
                             -2.0 * kDamping / kLawT_s * kStart_N);
  runLoop(config, kAssumed_N_per_m, [&](double t_s, double F_N) {
    EXPECT_NEAR(F_N, expected.at(t_s), kTolerance_N) << t_s;
    return expected.at(t_s) > 0.1 && !testing::Test::HasFailure();
  });
}

}  // namespace
}  // namespace tactus
