#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/expanded_pseudoinverse.h"
#include "support/period.h"

/// Robots of every size, without a change of code.
namespace tactus {
namespace {

using test::kPeriod_s;

class RobotOfSize : public testing::TestWithParam<int> {};

TEST_P(RobotOfSize, RunsEveryVariantWithinItsLimits) {
  test::Random random(200 + GetParam());
  for (const auto& [variant, level] : test::allLaws()) {
    const ControllerConfig config = test::fullController(random, GetParam(), variant, level);
    const Controller controller(config);
    const auto run = test::record(controller, random, 2000);
    JointVector before = JointVector::Zero(GetParam());
    for (const test::RecordedCycle& cycle : run) {
      const JointVector& v = cycle.output.velocity;
      ASSERT_EQ(cycle.output.fault, Fault::kNone);
      ASSERT_EQ(v.size(), GetParam());
      ASSERT_LE((v.cwiseAbs() - config.limits.max_velocity).maxCoeff(), 0.0);
      ASSERT_LE(((v - before).cwiseAbs() - kPeriod_s * config.limits.max_acceleration).maxCoeff(),
                1e-12);
      ASSERT_LE((cycle.output.q_desired.cwiseAbs() - config.limits.upper).maxCoeff(), 0.0);
      before = v;
    }
  }
}

TEST_P(RobotOfSize, FollowsItsTaskWithoutContact) {
  test::Random random(220 + GetParam());
  const int n = GetParam();
  int followed = 0;
  for (int i = 0; i < 20; ++i) {
    ControllerConfig config = test::randomController(random, n, random.integer(1, std::min(n, 6)));
    config.weights = test::randomWeights(random, n);
    config.gains.task.drift_gain_per_s = 20.0;
    config.force_control.emplace();
    // A short tool motion that any pose away from singularities can make.
    Waypoint line;
    line.displacement_m = random.vector<Vector3>(3, -0.01, 0.01);
    line.rotation_vector_rad = random.vector<Vector3>(3, -0.02, 0.02);
    line.speed_m_per_s = 0.02;
    config.task.trajectory.waypoints = {line};
    const TaskJacobian J = test::tipJacobian(config.chain, config.q_start,
                                             config.task.components.data(), config.task.size);
    const Eigen::MatrixXd J_scaled = J * config.weights.cwiseSqrt().cwiseInverse().asDiagonal();
    WeightedPseudoinverse factors;
    factors.factorise(J, test::inverseSquareRoot(config.weights));
    if (factors.damped()) continue;
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    for (int cycle = 0; cycle < 3000; ++cycle)
      controller.update({state.q_desired, test::touchAt(0.1, 0.0, 0.0, cycle + 1)},
                        controller.initialGains(), cycle * kPeriod_s, kPeriod_s, state, output);
    // Near singularities a damped task may lag; most robots must arrive.
    followed += output.error.norm() < 1e-6;
  }
  EXPECT_GE(followed, 3);
}

INSTANTIATE_TEST_SUITE_P(Joints, RobotOfSize, testing::Values(2, 3, 6, 7, 9, 16));

}  // namespace
}  // namespace tactus
