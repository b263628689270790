#include "tactus/control/clearance.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "support/random_clearance.h"
#include "support/random_limits.h"
#include "support/task_kinematics.h"
#include "tactus/control/command_limiter.h"
#include "tactus/control/joint_limit_rows.h"

/// Runs against everything that an arm must keep clear of: whatever is commanded, no distance
/// becomes less than the safe one. TACTUS_CLEARANCE_RUNS runs more of them.
namespace tactus {
namespace {

int clearanceRuns(int usual) {
  const char* const runs = std::getenv("TACTUS_CLEARANCE_RUNS");
  return runs ? std::atoi(runs) : usual;
}

/// An arm that starts clear and is commanded by limiter and clearance alone.
struct GuardedArm {
  explicit GuardedArm(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        config(test::randomController(random, n, random.integer(1, std::min(n, 3)))),
        period_s(random.chance(0.5) ? 0.001 : random.logUniform(2e-4, 0.02)) {
    config.limits.lower = config.q_start - random.vector(n, 0.0, 2.0);
    config.limits.upper = config.q_start + random.vector(n, 0.0, 2.0);
    for (int i = 0; i < n; ++i) {
      config.limits.max_velocity[i] = random.logUniform(0.1, 5.0);
      config.limits.max_acceleration[i] = random.logUniform(1.0, 500.0);
    }
    config.clearance = test::randomBodies(random, n);
    test::leaveOutTouching(config.chain, config.q_start, *config.clearance);
    clearance.emplace(config);
    q = config.q_start;
    v = JointVector::Zero(n);
  }

  /// One cycle of what a controller does with `wanted`; with rows or without.
  void step(JointVector wanted, bool has_rows) {
    config.chain.computePose(q, kinematics.pose);
    clearance->findNear(kinematics.pose, near);
    if (has_rows) keepRows(wanted);
    const JointVector before = v;
    CommandLimiter(config.limits).apply(q, before, period_s, wanted);
    clearance->holdBack(kinematics.pose, near, q, before, period_s, wanted);
    const JointVector change = (wanted - before).cwiseAbs();
    ASSERT_LE((change - period_s * config.limits.max_acceleration).maxCoeff(), 1e-12);
    ASSERT_LE((wanted.cwiseAbs() - config.limits.max_velocity).maxCoeff(), 1e-12);
    v = wanted;
    q += period_s * v;
    ASSERT_GE((q - config.limits.lower).minCoeff(), -1e-12);
    ASSERT_LE((q - config.limits.upper).maxCoeff(), 1e-12);
  }

  void keepRows(JointVector& wanted) {
    const ScaledVector ones = ScaledVector::Ones();
    test::computeTaskKinematics(config, q, ones, kinematics);
    SpeedRows rows;
    clearance->add(near, kinematics, ones, q, v, period_s, rows);
    JointLimitRows(config.limits, true).add(q, kinematics, ones, 1.0, rows);
    Motion motion;
    motion.y.setZero();
    motion.v_scaled = scaled(wanted, ones);
    RowProblem(rows, config.task.size).keep(motion);
    wanted = (motion.v_scaled + kinematics.pseudoinverse.expand(motion.y)).head(n);
  }

  double nearest() {
    ChainPose pose;
    config.chain.computePose(q, pose);
    return nearestBody(clearance->distances(), pose).distance_m;
  }

  int n;
  ControllerConfig config;
  double period_s;
  std::optional<Clearance> clearance;
  TaskKinematics kinematics;
  NearBodies near;
  JointVector q, v;
};

/// Pushes that change at once, of any size, and stops at any time.
TEST(Clearance, IsKeptWhateverIsCommanded) {
  test::Random random(411);
  int close = 0;
  const int runs = clearanceRuns(300);
  for (int run = 0; run < runs; ++run) {
    GuardedArm arm(random);
    const double d_s = arm.config.clearance->safe_distance_m;
    const bool has_rows = random.chance(0.7);
    JointVector wanted = JointVector::Zero(arm.n);
    double least_m = kNoLimit;
    for (int cycle = 0; cycle < 400; ++cycle) {
      if (random.chance(0.01)) {
        const double size = random.logUniform(0.1, 20.0);
        wanted = random.vector(arm.n, -size, size);
      }
      if (random.chance(0.005)) wanted.setZero();
      arm.step(wanted, has_rows);
      if (HasFatalFailure()) FAIL() << run;
      least_m = std::min(least_m, arm.nearest());
      ASSERT_GE(least_m, d_s - 1e-12) << "run " << run << " cycle " << cycle << " " << has_rows;
    }
    close += least_m < d_s + 5e-3 ? 1 : 0;
  }
  EXPECT_GT(close, runs / 8);
}

/// A command that leads along what is near, or away from it, is not held back for it.
TEST(Clearance, LetsAnArmGoWhereItIsClear) {
  test::Random random(412);
  int clear = 0, all = 0;
  for (int i = 0; i < 3000; ++i) {
    GuardedArm arm(random);
    arm.config.limits = test::noLimits(arm.n);
    arm.clearance.emplace(arm.config);
    arm.step(JointVector::Zero(arm.n), false);
    if (arm.near.size == 0) continue;
    JointVector away = JointVector::Zero(arm.n);
    for (int k = 0; k < arm.near.size; ++k)
      away +=
          arm.clearance->distances().gradient(arm.kinematics.pose, arm.near.body[k]).head(arm.n);
    away *= 0.05;
    JointVector passed = away;
    arm.clearance->holdBack(arm.kinematics.pose, arm.near, arm.q, arm.v, arm.period_s, passed);
    ++all;
    clear += passed == away ? 1 : 0;
  }
  EXPECT_GT(all, 500);
  EXPECT_GT(clear, 9 * all / 10);
}

/// A joint that stands on a limit keeps within it: the others go on.
TEST(Clearance, LetsAnArmGoThatRestsOnItsLimits) {
  test::Random random(413);
  for (int i = 0; i < 300; ++i) {
    GuardedArm arm(random);
    ClearanceConfig& bodies = *arm.config.clearance;
    bodies.pairs.clear();
    bodies.wall_pairs.clear();
    JointVector wanted = random.vector(arm.n, -0.05, 0.05);
    arm.config.limits = test::noLimits(arm.n);
    for (int joint = 0; joint < arm.n; ++joint) {
      if (random.chance(0.5)) continue;
      const bool is_lower = random.chance(0.5);
      (is_lower ? arm.config.limits.lower : arm.config.limits.upper)[joint] = arm.q[joint];
      wanted[joint] = random.chance(0.5) ? 0.0 : (is_lower ? 1.0 : -1.0) * std::abs(wanted[joint]);
    }
    arm.config.limits.max_acceleration.setConstant(10.0);
    arm.clearance.emplace(arm.config);
    arm.config.chain.computePose(arm.q, arm.kinematics.pose);
    JointVector passed = wanted;
    arm.clearance->holdBack(arm.kinematics.pose, arm.near, arm.q, arm.v, arm.period_s, passed);
    ASSERT_EQ(passed, wanted) << i;
    const JointLimits& limits = arm.config.limits;
    const auto canStop = [&](int joint, double speed) {
      JointVector beyond = wanted;
      beyond[joint] = speed;
      return arm.clearance->canStopAfter(arm.kinematics.pose, arm.near, arm.q, beyond,
                                         arm.period_s);
    };
    for (int joint = 0; joint < arm.n; ++joint) {
      ASSERT_FALSE(limits.lower[joint] == arm.q[joint] && canStop(joint, -1e-3));
      ASSERT_FALSE(limits.upper[joint] == arm.q[joint] && canStop(joint, 1e-3));
    }
  }
}

constexpr double kTurned_m = 0.5;
constexpr double kTurningBall_m = 0.05;
constexpr double kKept_m = 0.02;
constexpr double kRowsFrom_m = 0.1;
constexpr double kTurnCycle_s = 0.001;

/// A ball at the end of an arm that turns about z: at 0 rad it moves straight to the wall.
struct ArmBeforeAWall {
  explicit ArmBeforeAWall(double distance_m, const Vector3& to_wall = Vector3::UnitY())
      : config{.chain = SerialChain(std::vector<Joint>(2), {1, {}})}, q(JointVector::Zero(2)) {
    config.q_start = q;
    config.limits = test::noLimits(2);
    config.limits.max_acceleration.setConstant(10.0);
    ClearanceConfig& clear = config.clearance.emplace();
    LinkCapsule ball;
    ball.link.joint = 0;
    ball.p_LinkFrom = ball.p_LinkTo = kTurned_m * Vector3::UnitX();
    ball.radius_m = kTurningBall_m;
    clear.capsules = {ball};
    clear.walls = {HalfSpace{
        to_wall.dot(ball.p_LinkTo) * to_wall + (distance_m + kTurningBall_m) * to_wall, -to_wall}};
    clear.wall_pairs = {{0, 0}};
    clear.safe_distance_m = kKept_m;
    clear.influence_distance_m = kRowsFrom_m;
    clearance.emplace(config);
    config.chain.computePose(q, kinematics.pose);
    const ScaledVector ones = ScaledVector::Ones();
    kinematics.pseudoinverse.factorise(TaskJacobian(TaskJacobian::Constant(1, 2, kTurned_m)), ones);
    clearance->findNear(kinematics.pose, kinematics.near);
  }

  ControllerConfig config;
  JointVector q;
  std::optional<Clearance> clearance;
  TaskKinematics kinematics;
};

/// 1 rad/s at 10 rad/s^2: 100 cycles, which add up to 50.5.
const JointVector kTurn{{1.0, 0.0}};
constexpr double kTurn_s = 0.0505;
constexpr double kTurn_m = kTurned_m * kTurn_s;
constexpr double kBend_m = 0.5 * kTurned_m * kTurn_s * kTurn_s;

TEST(ClearanceOfAnArmThatTurns, HasRowsThatKnowHowItsWayBends) {
  const ArmBeforeAWall arm(0.06);
  SpeedRows rows;
  arm.clearance->add(arm.kinematics.near, arm.kinematics, ScaledVector::Ones(), arm.q, kTurn,
                     kTurnCycle_s, rows);
  ASSERT_EQ(rows.size, 1);
  EXPECT_NEAR(rows.row[0].v_max_m_per_s, 5.0 * (0.06 - kKept_m - 1e-3 - kBend_m) / 0.5, 1e-12);
}

/// It does not come nearer than the ball's own way, nor bend more than that; one bound is enough.
TEST(ClearanceOfAnArmThatTurns, CanStopWhereItsWayIsNotTooLong) {
  for (const double more_m : {-1e-6, 1e-6, 0.5 * kBend_m, kBend_m, 2.0 * kBend_m}) {
    const ArmBeforeAWall arm(kKept_m + kTurn_m + more_m);
    EXPECT_EQ(arm.clearance->canStopAfter(arm.kinematics.pose, arm.kinematics.near, arm.q, kTurn,
                                          kTurnCycle_s),
              more_m > 0.0)
        << more_m;
  }
}

/// Along the wall at first: what brings it nearer is how its way bends.
TEST(ClearanceOfAnArmThatTurns, CanStopWhereItsWayDoesNotBendTooFar) {
  for (const double bends : {0.5, 0.99, 1.01, 1.5}) {
    const ArmBeforeAWall arm(kKept_m + bends * kBend_m, Vector3::UnitX());
    EXPECT_EQ(arm.clearance->canStopAfter(arm.kinematics.pose, arm.kinematics.near, arm.q, kTurn,
                                          kTurnCycle_s),
              bends > 1.0)
        << bends;
  }
}

}  // namespace
}  // namespace tactus
