#include "tactus/control/posture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_robot.h"
#include "tactus/control/controller.h"

namespace tactus {
namespace {

constexpr double kPostureCycle_s = 0.02;

struct PostureCase {
  explicit PostureCase(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        q_posture(random.vector(n, -3.0, 3.0)),
        q(random.vector(n, -3.0, 3.0)),
        max_velocity(random.vector(n, 0.1, 5.0)),
        inv_sqrt_weights(random.vector(kMaxJoints, 0.1, 3.0)) {
    gains = {random.uniform(0.05, 10.0), random.uniform(0.01, 1.0)};
  }

  JointVector velocity(const JointVector& most) const {
    const ScaledVector gradient = Posture(q_posture, most, inv_sqrt_weights).gradient(gains, q);
    return -gradient.cwiseProduct(inv_sqrt_weights).head(n);
  }

  int n;
  JointVector q_posture, q, max_velocity;
  ScaledVector inv_sqrt_weights;
  PostureGains gains;
};

TEST(Posture, IsTheGradientOfACost) {
  test::Random random(811);
  for (int i = 0; i < 500; ++i) {
    const PostureCase c(random);
    const JointVector weights = c.inv_sqrt_weights.head(c.n).cwiseAbs2().cwiseInverse();
    const auto cost = [&](const JointVector& q) {
      return 0.5 * c.gains.gain_per_s * weights.dot((q - c.q_posture).cwiseAbs2());
    };
    const Posture posture(c.q_posture, test::noLimits(c.n).max_velocity, c.inv_sqrt_weights);
    const ScaledVector gradient = posture.gradient(c.gains, c.q);
    ASSERT_EQ(gradient.tail(kMaxJoints - c.n).norm(), 0.0);
    for (int k = 0; k < c.n; ++k) {
      const JointVector step = 1e-3 * JointVector::Unit(c.n, k);
      const double slope = (cost(c.q + step) - cost(c.q - step)) / 2e-3;
      ASSERT_NEAR(gradient[k] / c.inv_sqrt_weights[k], slope, 1e-8 * (1.0 + std::abs(slope)));
    }
  }
}

TEST(Posture, IsBoundedInItsSpeedAndNotTurned) {
  test::Random random(812);
  int bounded = 0;
  for (int i = 0; i < 500; ++i) {
    const PostureCase c(random);
    const JointVector free = c.velocity(test::noLimits(c.n).max_velocity);
    const JointVector velocity = c.velocity(c.max_velocity);
    const JointVector most = c.gains.max_speed_share * c.max_velocity;
    const double share = velocity.norm() / free.norm();
    ASSERT_LT((velocity - share * free).norm(), 1e-12 * free.norm());
    ASSERT_LE(velocity.cwiseQuotient(most).cwiseAbs().maxCoeff(), 1.0 + 1e-12);
    if (velocity == free) continue;
    ++bounded;
    ASSERT_NEAR(velocity.cwiseQuotient(most).cwiseAbs().maxCoeff(), 1.0, 1e-12) << "slower still";
  }
  EXPECT_GT(bounded, 100);
  EXPECT_LT(bounded, 500);
}

/// An arm that holds its tool, whose null space alone is led.
struct HoldingArm {
  HoldingArm(test::Random& random, ControlLevel level)
      : config(test::randomController(random, random.integer(5, 9), 3)) {
    config.task.components = {0, 1, 2};
    config.weights = test::randomWeights(random, config.chain.size());
    config.limits.max_velocity.setConstant(2.0);
    config.has_joint_limit_avoidance = true;
    config.q_posture = config.q_start + random.vector(config.chain.size(), -0.5, 0.5);
    config.gains.posture = {random.uniform(0.2, 2.0), random.uniform(0.02, 0.2)};
    config.force_control.emplace();
    config.force_control->level = level;
  }

  double cost(const JointVector& q) const {
    return config.weights.dot((q - *config.q_posture).cwiseAbs2());
  }

  ControllerConfig config;
};

TEST(Posture, IsComeNearerWhileTheToolStays) {
  test::Random random(813);
  for (const ControlLevel level : {ControlLevel::kVelocity, ControlLevel::kAcceleration}) {
    for (int i = 0; i < 20; ++i) {
      const HoldingArm arm(random, level);
      const Controller controller(arm.config);
      ControllerState state = controller.initialState();
      controller.begin(state);
      ControllerOutput output;
      const Vector3 p_start = tipPose(arm.config.chain, state.q_desired).p_AB;
      const double at_first = arm.cost(state.q_desired);
      double before = at_first;
      for (int cycle = 0; cycle < 6000; ++cycle) {
        RobotInput input;
        input.q_measured = state.q_desired;
        input.tactile[0].sequence = static_cast<std::uint32_t>(cycle + 1);
        controller.update(input, arm.config.gains, cycle * kPostureCycle_s, kPostureCycle_s, state,
                          output);
        ASSERT_EQ(output.fault, Fault::kNone);
        const double now = arm.cost(state.q_desired);
        ASSERT_LE(now, before + 1e-3 * at_first) << "in cycle " << cycle;  // the tool comes back
        before = now;
        const Vector3 p = tipPose(arm.config.chain, state.q_desired).p_AB;
        ASSERT_LT((p - p_start).norm(), 2e-3);
      }
      EXPECT_LT(before, 0.99 * at_first);
      EXPECT_LT(output.velocity.norm(), 2e-3) << "as near as the tool lets it";
    }
  }
}

/// A run of cycles, that is, and how fast it was in the first and at most.
struct Speeds {
  double first = 0.0, most = 0.0;

  Speeds(const HoldingArm& arm, const Controller& controller, int cycles, ControllerState& state) {
    ControllerOutput output;
    for (int cycle = 0; cycle < cycles; ++cycle) {
      RobotInput input;
      input.q_measured = state.q_desired;
      input.tactile[0].sequence = ++state.modules[0].sequence + 1;
      controller.update(input, arm.config.gains, 0.0, kPostureCycle_s, state, output);
      EXPECT_EQ(output.fault, Fault::kNone);
      if (cycle == 0) first = output.velocity.norm();
      most = std::max(most, output.velocity.norm());
    }
  }
};

/// The first cycle would else be a jump to the whole speed.
TEST(Posture, BeginsSoftlyAlsoWhereTheSceneBegins) {
  test::Random random(814);
  for (int i = 0; i < 20; ++i) {
    const HoldingArm arm(random, ControlLevel::kVelocity);
    const Controller controller(arm.config);
    ControllerState state = controller.initialState();
    controller.begin(state);
    controller.goOn(arm.config.gains, state);
    const Speeds begun(arm, controller, 150, state);
    EXPECT_GT(begun.most, 1e-3);
    EXPECT_LT(begun.first, 0.02 * begun.most);
  }
}

/// As when somebody switches the enable line off and on again.
TEST(Posture, GoesOnSoftlyAfterAHold) {
  test::Random random(815);
  for (int i = 0; i < 20; ++i) {
    const HoldingArm arm(random, ControlLevel::kVelocity);
    const Controller controller(arm.config);
    ControllerState state = controller.initialState();
    controller.begin(state);
    const double before = Speeds(arm, controller, 150, state).most;
    state.is_stopping = true;
    Speeds(arm, controller, 150, state);
    ASSERT_TRUE(state.velocity_before.isZero(0.0));
    state.is_stopping = false;
    controller.goOn(arm.config.gains, state);
    const Speeds after(arm, controller, 150, state);
    EXPECT_GT(after.most, 1e-3) << "was " << before;
    EXPECT_LT(after.first, 0.02 * after.most);
  }
}

/// What held a push off is back at once there; a posture has held nothing off.
TEST(Posture, GoesOnSoftlyWhereTheArmLeansOnSomething) {
  test::Random random(816);
  for (int i = 0; i < 20; ++i) {
    const HoldingArm arm(random, ControlLevel::kVelocity);
    const Controller controller(arm.config);
    ControllerState state = controller.initialState();
    controller.begin(state);
    Speeds(arm, controller, 150, state);
    controller.restart(arm.config.gains, state);
    state.modules[0].contact.force_N = 5.0;
    controller.place(JointVector(state.q_desired), arm.config.gains, state);
    ASSERT_TRUE(state.is_leaning);
    EXPECT_TRUE(state.way_out_before.isZero(0.0)) << "there are no limits";
    EXPECT_GT(state.way_out_added.norm(), 0.0);
  }
}

TEST(Posture, OfNoGainChangesNoBit) {
  test::Random random(817);
  HoldingArm arm(random, ControlLevel::kVelocity);
  arm.config.gains.posture.gain_per_s = 0.0;
  ControllerConfig without = arm.config;
  without.q_posture.reset();
  arm.config.limits.lower = without.limits.lower = arm.config.q_start.array() - 0.3;
  arm.config.limits.upper = without.limits.upper = arm.config.q_start.array() + 1.0;
  const Controller with_it(arm.config), without_it(without);
  ControllerState a = with_it.initialState(), b = without_it.initialState();
  ControllerOutput of_a, of_b;
  for (int cycle = 0; cycle < 500; ++cycle) {
    RobotInput input;
    input.q_measured = a.q_desired;
    input.tactile[0].sequence = static_cast<std::uint32_t>(cycle + 1);
    with_it.update(input, arm.config.gains, cycle * kPostureCycle_s, kPostureCycle_s, a, of_a);
    without_it.update(input, arm.config.gains, cycle * kPostureCycle_s, kPostureCycle_s, b, of_b);
    ASSERT_EQ(of_a.velocity, of_b.velocity);
  }
  EXPECT_GT(of_a.velocity.norm(), 0.0);
}

}  // namespace
}  // namespace tactus
