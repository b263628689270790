#include "tactus/control/return_speed.h"

#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/expanded_pseudoinverse.h"
#include "support/rail_robot.h"

/// The correction of (2) is capped as a whole, position and rotation each by its own key.
namespace tactus {
namespace {

/// The components of position, or of rotation, of a vector of the task.
Eigen::VectorXd partOf(const TaskConfig& task, const TaskVector& v, bool is_position) {
  Eigen::VectorXd part = Eigen::VectorXd::Zero(6);
  for (int i = 0; i < task.size; ++i)
    if ((task.components[i] < 3) == is_position) part[task.components[i]] = v[i];
  return part;
}

void expectPart(const Eigen::VectorXd& limited, const Eigen::VectorXd& wanted, double cap) {
  if (wanted.norm() <= cap) {
    EXPECT_EQ(limited, wanted) << "to the bit";
    return;
  }
  EXPECT_NEAR(limited.norm(), cap, 1e-14 * cap);
  EXPECT_LT((limited / cap - wanted.normalized()).norm(), 1e-14) << "another direction";
}

TEST(ReturnSpeed, IsCappedWithItsDirectionKept) {
  test::Random random(261);
  int capped = 0;
  for (int i = 0; i < 2000; ++i) {
    TaskConfig task;
    TaskGains gains;
    task.components = test::randomComponents(random);
    task.size = random.integer(1, 6);
    if (random.chance(0.7)) gains.max_return_speed_m_per_s = random.logUniform(1e-3, 10.0);
    if (random.chance(0.7)) gains.max_return_speed_rad_per_s = random.logUniform(1e-3, 10.0);
    const TaskVector wanted = random.vector<TaskVector>(task.size, -2.0, 2.0);
    TaskVector limited = wanted;
    limitReturnSpeed(gains, task, {}, limited);
    expectPart(partOf(task, limited, true), partOf(task, wanted, true),
               gains.max_return_speed_m_per_s);
    expectPart(partOf(task, limited, false), partOf(task, wanted, false),
               gains.max_return_speed_rad_per_s);
    capped += limited != wanted;
  }
  EXPECT_GT(capped, 500);
}

TEST(ReturnSpeed, IsCappedAtOneMetrePerSecondToo) {
  TaskConfig task;
  task.components = {0};
  task.size = 1;
  TaskGains gains;
  gains.max_return_speed_m_per_s = 0.25;
  TaskVector correction = TaskVector::Ones(1);
  limitReturnSpeed(gains, task, {}, correction);
  EXPECT_EQ(correction[0], 0.25);
}

/// In contact the law holds the correction off: together they are no faster than the key.
TEST(ReturnSpeed, IsThatOfTheToolWhichTheLawPushes) {
  TaskConfig task;
  TaskGains gains;
  task.components = {4, 1, 0};
  task.size = 3;
  gains.max_return_speed_m_per_s = 0.2;
  const TaskVector wanted = Vector3(3.0, 1.2, 1.6);
  const auto limitedWith = [&](const Vector3& push) -> Vector3 {
    TaskVector correction = wanted;
    limitReturnSpeed(gains, task, push, correction);
    return correction;
  };
  EXPECT_LT((limitedWith({0, 0, 0}) - Vector3(3.0, 0.12, 0.16)).norm(), 1e-15);
  EXPECT_LT((limitedWith({9, -0.18, -0.24}) - Vector3(3.0, 0.3, 0.4)).norm(), 1e-15)
      << "against it";
  EXPECT_LT((limitedWith({9, 0.06, 0.08}) - Vector3(3.0, 0.06, 0.08)).norm(), 1e-15) << "with it";
  EXPECT_LT((limitedWith({9, 0.8, -0.6}) - Vector3(3.0, 0.12, 0.16)).norm(), 1e-15) << "across";
  EXPECT_EQ(limitedWith({0, -1.2, -1.6}), wanted) << "to the bit, where the tool is at rest";
  EXPECT_EQ(limitedWith({0, 0.6, 0.8}), Vector3(3.0, 0.0, 0.0));
}

TEST(ReturnSpeed, LeavesRestAndWhatIsNoNumber) {
  TaskConfig task;
  TaskGains gains;
  task.components = {0, 3};
  task.size = 2;
  gains.max_return_speed_m_per_s = gains.max_return_speed_rad_per_s = 0.1;
  TaskVector correction = TaskVector::Zero(2);
  limitReturnSpeed(gains, task, {}, correction);
  EXPECT_TRUE(correction.isZero(0.0));
  correction[0] = kNoLimit - kNoLimit;
  limitReturnSpeed(gains, task, {}, correction);
  EXPECT_NE(correction[0], correction[0]) << "the command must show that it is broken";
}

/// An arm of nine joints that has been pushed off its reference, with all six components.
struct PushedArm {
  PushedArm(std::uint64_t seed, double size_rad)
      : random(seed),
        config(test::randomController(random, 9, 6)),
        push(random.vector(9, -size_rad, size_rad)) {
    config.tactile_modules.clear();
  }

  ControllerOutput respond() const {
    const Controller controller(config);
    ControllerState state = controller.initialState();
    state.q_desired += push;
    ControllerOutput output;
    controller.update({}, controller.initialGains(), 0.0, 1e-3, state, output);
    return output;
  }

  /// The tool's speed in the components of the task.
  TaskVector toolSpeed(const ControllerOutput& output) const {
    return test::tipJacobian(config.chain, output.q_desired, config.task.components.data(),
                             config.task.size) *
           output.velocity;
  }

  test::Random random;
  ControllerConfig config;
  JointVector push;
};

TEST(ReturnSpeed, OfAToolInSpaceIsThatOfItsKeys) {
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    PushedArm arm(seed, 0.2);
    arm.config.gains.task.max_return_speed_m_per_s = 0.05;
    arm.config.gains.task.max_return_speed_rad_per_s = 0.1;
    const ControllerOutput output = arm.respond();
    const TaskConfig& task = arm.config.task;
    const TaskVector speed = arm.toolSpeed(output);
    TaskVector expected = 5.0 * output.error;
    limitReturnSpeed(arm.config.gains.task, task, {}, expected);
    if ((speed - expected).norm() > 1e-9) continue;  // damped: slower still
    EXPECT_NEAR(partOf(task, speed, true).norm(), 0.05, 1e-9);
    EXPECT_NEAR(partOf(task, speed, false).norm(), 0.1, 1e-9);
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

TEST(ReturnSpeed, ChangesNoBitOfACommandBelowIt) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    PushedArm arm(seed, 0.01);
    const ControllerOutput free = arm.respond();
    EXPECT_GT(arm.toolSpeed(free).norm(), 1e-3);
    arm.config.gains.task.max_return_speed_m_per_s =
        5.001 * partOf(arm.config.task, free.error, true).norm();
    arm.config.gains.task.max_return_speed_rad_per_s = 1.0;
    test::expectSame(arm.respond(), free);
  }
}

/// An arm that its drives had let go may stand beside its path: there beta grows from zero.
TEST(ReturnSpeed, RisesGentlyBesideThePath) {
  PushedArm arm(3, 0.05);
  arm.config.has_joint_limit_avoidance = false;
  arm.config.task.trajectory = {};
  const Controller controller(arm.config);
  ControllerState state = controller.initialState();
  controller.restart(controller.initialGains(), state);
  controller.place(arm.config.q_start + arm.push, controller.initialGains(), state);
  ControllerOutput output;
  PreparedCycle prepared;
  ControllerState held = controller.initialState();  // of an arm that was not let go
  controller.prepare(controller.initialGains(), 0.0, held, prepared);
  double error_before = 0.0, peak = 0.0;
  double first = 0.0;
  for (int i = 0; i < 5000; ++i) {
    controller.update({}, controller.initialGains(), 0.0, 1e-3, prepared, state, output);
    controller.prepare(controller.initialGains(), 0.0, state, prepared);
    if (i == 0) first = output.error.norm();
    if (i > 0) peak = std::max(peak, (error_before - output.error.norm()) / 1e-3);
    error_before = output.error.norm();
  }
  EXPECT_GT(first, 0.01);
  EXPECT_LT(peak, 1.0 * first);
  EXPECT_GT(peak, 0.8 * first) << "it does go back";
  EXPECT_LT(error_before, 1e-3 * first);
}

/// An arm that starts deep in the zone of joint limits, and follows their gradient alone.
struct ArmInAZone {
  explicit ArmInAZone(std::uint64_t seed) : arm(seed, 0.0) {
    arm.config.task.trajectory = {};
    arm.config.weights.setOnes();
    arm.config.gains.task.drift_gain_per_s = 0.0;
    arm.config.has_joint_limit_avoidance = true;
    arm.config.gains.joint_limit_avoidance.gradient_at_limit = 20.0;
    arm.config.limits.upper = in_zone.array() + 0.01;
    arm.config.limits.lower = in_zone.array() - 1.0;
    arm.config.limits.max_acceleration.setConstant(1e6);
  }

  PushedArm arm;
  const JointVector& in_zone = arm.config.q_start;
};

JointVector run(const Controller& controller, ControllerState& state, int cycles) {
  ControllerOutput output;
  for (int i = 0; i < cycles; ++i)
    controller.update({}, controller.initialGains(), 0.0, 1e-3, state, output);
  return output.velocity;
}

/// Likewise it may stand in a joint limit's zone, where its drives came to rest.
TEST(ReturnSpeed, RisesGentlyOutOfAJointLimitsZone) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ArmInAZone it(seed);
    const Controller controller(it.arm.config);
    ControllerState plain = controller.initialState();
    const double at_once = run(controller, plain, 1).norm();
    ControllerState state = controller.initialState(it.in_zone.array() - 0.5);
    run(controller, state, 1);
    controller.restart(controller.initialGains(), state);
    controller.place(it.in_zone, controller.initialGains(), state);
    double peak = 0.0;
    for (int i = 0; i < 5000; ++i) peak = std::max(peak, run(controller, state, 1).norm());
    EXPECT_LT(peak, 0.1 * at_once);
    run(controller, plain, 5000);
    EXPECT_LT((state.q_desired - plain.q_desired).norm(),
              0.5 * (it.in_zone - plain.q_desired).norm())
        << "it does leave the zone";
    controller.restart(controller.initialGains(), state);
    controller.place(it.in_zone, controller.initialGains(), state);
    const double gentle = run(controller, state, 500).norm();
    controller.restart(controller.initialGains(), state);  // anew, while it leaves gently
    controller.place(JointVector(state.q_desired), controller.initialGains(), state);
    EXPECT_LT(run(controller, state, 1).norm(), 1.1 * gentle);
    EXPECT_LT(gentle, 0.2 * at_once);
  }
}

/// What held a contact's push off before the stop is there again as fast as the law's answer; where
/// nothing pushes any more, it comes as gently as all else.
TEST(ReturnSpeed, OfAWayOutIsSoonAsBeforeTheStopWhereTheArmLeansOnSomething) {
  test::Random random(264);
  ControllerConfig config = test::fullController(random, 7, Variant::kNullSpace);
  config.has_joint_limit_avoidance = true;
  config.limits.upper = config.q_start.array() + 0.01;
  config.limits.lower = config.q_start.array() - 1.0;
  const Controller controller(config);
  const Gains& gains = controller.initialGains();
  for (const double force_N : {0.5, 0.0}) {  // below F_th: the law answers with nothing
    ControllerState state = controller.initialState();
    ControllerOutput output;
    std::uint32_t sample = 0;
    const auto cycle = [&] {
      const RobotInput input{config.q_start, test::touchAt(0.2, force_N, 0.4, ++sample)};
      controller.update(input, gains, 0.0, 1e-3, state, output);
    };
    for (int i = 0; i < 10; ++i) cycle();
    controller.restart(gains, state);
    controller.place(config.q_start, gains, state);
    EXPECT_EQ(state.is_leaning, force_N > 0.0);
    ScaledVector at_first = state.way_out_before;
    ScaledVector soon = state.way_out_before;
    ScaledVector before = ScaledVector::Zero();
    if (state.is_leaning) before = state.way_out_before;
    EXPECT_GT(soon.norm(), 0.1);
    softenWayOut(0.0, before, state.way_out_added, at_first);
    softenWayOut(kAnswerRise_s / kReturnRise_s, before, state.way_out_added, soon);
    EXPECT_LT(at_first.norm(), 0.05 * state.way_out_before.norm());
    const double share = soon.norm() / state.way_out_before.norm();
    EXPECT_GT(share, force_N > 0.0 ? 0.95 : 0.05);
    EXPECT_LT(share, force_N > 0.0 ? 1.01 : 0.2);
  }
}

/// Never more than the law's way out, nor against it, wherever the joints have got to.
TEST(ReturnSpeed, SoftensAWayOutBetweenNothingAndAll) {
  test::Random random(262);
  const auto vector = [&random] { return random.vector<ScaledVector>(kMaxJoints, -2.0, 2.0); };
  for (int i = 0; i < 10000; ++i) {
    const double share = random.chance(0.1) ? 0.0 : random.uniform(0.0, 1.0);
    const ScaledVector before = vector();
    const ScaledVector added = vector();
    const ScaledVector way_out = vector();
    ScaledVector soft = way_out;
    softenWayOut(share, before, added, soft);
    EXPECT_TRUE((soft.array() * way_out.array() >= 0.0).all());
    EXPECT_TRUE((soft.cwiseAbs().array() <= way_out.cwiseAbs().array()).all());
    soft = way_out;
    softenWayOut(1.0, before, added, soft);
    EXPECT_EQ(soft, way_out);
  }
}

TEST(ReturnSpeed, LeavesWhatIsMetDeeperInTheZoneAlone) {
  test::Random random(263);
  for (int i = 0; i < 1000; ++i) {
    const ScaledVector before = random.vector<ScaledVector>(kMaxJoints, 0.0, 1.0);
    const ScaledVector added = random.vector<ScaledVector>(kMaxJoints, 0.0, 1.0);
    const ScaledVector deeper = random.vector<ScaledVector>(kMaxJoints, 0.0, 1.0);
    const double share = random.uniform(0.0, 1.0);
    ScaledVector where_it_stood = before + added;
    ScaledVector where_it_is = before + added + deeper;
    softenWayOut(share, before, added, where_it_stood);
    softenWayOut(share, before, added, where_it_is);
    EXPECT_LT((where_it_is - where_it_stood - deeper).norm(), 1e-14);
  }
}

/// Where a scene begins there, or the arm, which has rested free in a hold, goes on.
TEST(ReturnSpeed, RisesGentlyOutOfTheZoneThatAnArmBeginsOrGoesOnIn) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ArmInAZone it(seed);
    const Controller controller(it.arm.config);
    ControllerState plain = controller.initialState();
    const double at_once = run(controller, plain, 1).norm();
    ControllerState state = controller.initialState();
    controller.begin(state);
    EXPECT_LT(run(controller, state, 1).norm(), 0.01 * at_once);
    run(controller, state, 5000);
    EXPECT_GT((state.q_desired - it.in_zone).norm(), 0.1) << "it does leave the zone";
    ControllerState held = controller.initialState();
    const double before = run(controller, held, 20).norm();
    controller.hold(controller.initialGains(), held);
    controller.goOn(controller.initialGains(), held);
    EXPECT_LT(run(controller, held, 1).norm(), 0.01 * before);
  }
}

/// An encoder's rounding is no jump; more makes the arm return gently, in whichever joint it is.
TEST(ReturnSpeed, GrowsFromZeroWhereAnArmBeginsBesideItsStart) {
  ControllerConfig config = test::railController(Variant::kNone);
  config.q_start = JointVector{{0.3, -0.2}};
  const Controller controller(config);
  const auto shareFrom = [&](double beside_0, double beside_1) {
    ControllerState state = controller.initialState();
    controller.place(config.q_start + JointVector{{beside_0, beside_1}}, config.gains, state);
    controller.begin(state);
    return state.return_share;
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(shareFrom(sign * 0.9e-4, -sign * 0.9e-4), 1.0);
    EXPECT_EQ(shareFrom(sign * 1.1e-4, 0.0), 0.0);
    EXPECT_EQ(shareFrom(0.0, sign * 1.1e-4), 0.0);
  }
}

}  // namespace
}  // namespace tactus
