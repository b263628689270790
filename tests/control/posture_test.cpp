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

  ScaledVector gradient(const JointVector& most) const {
    ScaledVector sum = ScaledVector::Zero();
    Posture(q_posture, most, inv_sqrt_weights).addTo(sum, gains, q);
    return sum;
  }

  JointVector velocity(const JointVector& most) const {
    return -gradient(most).cwiseProduct(inv_sqrt_weights).head(n);
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
    const ScaledVector gradient = c.gradient(test::noLimits(c.n).max_velocity);
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
  explicit HoldingArm(const ControllerConfig& held)
      : config(held), controller(held), state(controller.initialState()) {}
  HoldingArm(test::Random& random, ControlLevel level) : HoldingArm(heldArm(random, level)) {
    controller.begin(state);
  }

  static ControllerConfig heldArm(test::Random& random, ControlLevel level) {
    ControllerConfig config = test::randomController(random, random.integer(5, 9), 3);
    config.task.components = {0, 1, 2};
    config.weights = test::randomWeights(random, config.chain.size());
    config.limits.max_velocity.setConstant(2.0);
    config.has_joint_limit_avoidance = true;
    config.q_posture = config.q_start + random.vector(config.chain.size(), -0.5, 0.5);
    config.gains.posture = {random.uniform(0.2, 2.0), random.uniform(0.02, 0.2)};
    config.force_control.emplace();
    config.force_control->level = level;
    return config;
  }

  double cost() const {
    return config.weights.dot((state.q_desired - *config.q_posture).cwiseAbs2());
  }

  Vector3 p_BaseTool() const { return tipPose(config.chain, state.q_desired).p_AB; }

  /// A cycle. Returns the commanded joint velocities.
  JointVector update() {
    RobotInput input;
    input.q_measured = state.q_desired;
    input.tactile[0].sequence = ++samples;
    ControllerOutput output;
    controller.update(input, config.gains, 0.0, kPostureCycle_s, state, output);
    EXPECT_EQ(output.fault, Fault::kNone);
    return output.velocity;
  }

  const ControllerConfig config;
  const Controller controller;
  ControllerState state;
  std::uint32_t samples = 0;
};

TEST(Posture, IsComeNearerWhileTheToolStays) {
  test::Random random(813);
  for (const ControlLevel level : {ControlLevel::kVelocity, ControlLevel::kAcceleration}) {
    for (int i = 0; i < 20; ++i) {
      HoldingArm arm(random, level);
      const Vector3 p_start = arm.p_BaseTool();
      const double at_first = arm.cost();
      double before = at_first;
      JointVector velocity;
      for (int cycle = 0; cycle < 6000; ++cycle) {
        velocity = arm.update();
        const double now = arm.cost();
        ASSERT_LE(now, before + 1e-3 * at_first) << "in cycle " << cycle;  // the tool comes back
        before = now;
        ASSERT_LT((arm.p_BaseTool() - p_start).norm(), 2e-3);
      }
      EXPECT_LT(before, 0.99 * at_first);
      EXPECT_LT(velocity.norm(), 2e-3) << "as near as the tool lets it";
    }
  }
}

/// Of 150 cycles, how fast the first was, and the fastest.
struct Speeds {
  explicit Speeds(HoldingArm& arm) {
    for (int cycle = 0; cycle < 150; ++cycle) {
      const double speed = arm.update().norm();
      if (cycle == 0) first = speed;
      most = std::max(most, speed);
    }
  }

  void expectSoft() const {
    EXPECT_GT(most, 1e-3);
    EXPECT_LT(first, 0.02 * most) << "a jump to the whole speed";
  }

  double first = 0.0, most = 0.0;
};

class SoftPosture : public ::testing::TestWithParam<int> {
 protected:
  test::Random random_{static_cast<std::uint64_t>(GetParam())};
  HoldingArm arm_{random_, ControlLevel::kVelocity};
};

INSTANTIATE_TEST_SUITE_P(Arms, SoftPosture, ::testing::Range(814, 834));

TEST_P(SoftPosture, BeginsSoftlyAlsoWhereTheSceneBegins) {
  arm_.controller.goOn(arm_.config.gains, arm_.state);
  Speeds(arm_).expectSoft();
}

/// As when somebody switches the enable line off and on again.
TEST_P(SoftPosture, GoesOnSoftlyAfterAHold) {
  Speeds moved(arm_);
  arm_.state.is_stopping = true;
  Speeds stopped(arm_);
  ASSERT_TRUE(arm_.state.velocity_before.isZero(0.0));
  arm_.state.is_stopping = false;
  arm_.controller.goOn(arm_.config.gains, arm_.state);
  Speeds(arm_).expectSoft();
}

/// Whoever touches it meanwhile is no contact that the law has held off.
TEST_P(SoftPosture, GoesOnSoftlyAfterAHoldInWhichItIsTouched) {
  Speeds moved(arm_);
  for (const bool was_touched : {true, false}) {
    ControllerState& state = arm_.state;
    state.modules[0].contact.force_N = was_touched ? 5.0 : 0.0;
    arm_.controller.hold(arm_.config.gains, state);
    state.is_stopping = true;
    Speeds stopped(arm_);
    state.is_stopping = false;
    state.return_share = 1.0;
    state.modules[0].contact.force_N = 5.0;
    arm_.controller.goOn(arm_.config.gains, state);
    EXPECT_EQ(state.return_share, was_touched ? 1.0 : 0.0) << "in balance";
  }
  Speeds(arm_).expectSoft();
}

/// What held a push off is back at once there; a posture has held nothing off.
TEST_P(SoftPosture, GoesOnSoftlyWhereTheArmLeansOnSomething) {
  Speeds moved(arm_);
  arm_.controller.restart(arm_.config.gains, arm_.state);
  arm_.state.modules[0].contact.force_N = 5.0;
  arm_.controller.place(JointVector(arm_.state.q_desired), arm_.config.gains, arm_.state);
  ASSERT_TRUE(arm_.state.is_leaning);
  EXPECT_TRUE(arm_.state.way_out_before.isZero(0.0)) << "there are no limits";
  EXPECT_GT(arm_.state.way_out_added.norm(), 0.0);
  // What it leans on is gone: the posture alone moves it.
  Speeds(arm_).expectSoft();
}

TEST(Posture, OfNoGainChangesNoBit) {
  test::Random random(817);
  ControllerConfig config = HoldingArm::heldArm(random, ControlLevel::kVelocity);
  config.gains.posture.gain_per_s = 0.0;
  config.limits.lower = config.q_start.array() - 0.3;
  config.limits.upper = config.q_start.array() + 1.0;
  ControllerConfig without = config;
  without.q_posture.reset();
  HoldingArm a(config), b(without);
  JointVector velocity;
  for (int cycle = 0; cycle < 500; ++cycle) {
    velocity = a.update();
    ASSERT_EQ(velocity, b.update());
  }
  EXPECT_GT(velocity.norm(), 0.0);
}

}  // namespace
}  // namespace tactus
