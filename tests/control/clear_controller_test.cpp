#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "support/controller_run.h"
#include "support/crops9.h"
#include "support/random_clearance.h"
#include "tactus/control/clearance.h"

/// Whole controllers with a clearance: tasks that lead anywhere, pushes of up to 100 N, stops and
/// retreats at any time. TACTUS_CLEARANCE_RUNS runs more of them.
namespace tactus {
namespace {

ControllerConfig clearController(test::Random& random) {
  const Variant variant = test::kAllVariants[random.index(std::size(test::kAllVariants))];
  const int n = random.integer(2, kMaxJoints);
  ControllerConfig config = test::fullController(random, n, variant);
  config.limits.max_velocity = random.vector(n, 0.5, 3.0);
  config.limits.max_acceleration.setConstant(random.logUniform(2.0, 300.0));
  config.has_joint_limit_avoidance = random.chance(0.5);
  if (config.has_joint_limit_avoidance) config.q_posture = JointVector::Constant(n, 0.3);
  for (Waypoint& waypoint : config.task.trajectory.waypoints) {
    waypoint.displacement_m = random.vector<Vector3>(3, -1.0, 1.0);
    waypoint.speed_m_per_s = random.logUniform(0.05, 2.0);
  }
  config.clearance = test::randomBodies(random, n);
  test::leaveOutTouching(config.chain, config.q_start, *config.clearance);
  return config;
}

/// Pushes that begin, grow and end.
RobotInput pushed(test::Random& random, int cycle, const JointVector& q, TactileSample& sample) {
  if (cycle % 4 == 0) {
    const double swell = std::sin(0.02 * cycle) + random.uniform(-0.1, 0.1);
    sample = test::touchAt(random.uniform(0.1, 0.3), std::clamp(150.0 * swell, 0.0, 99.0),
                           0.7 + 0.001 * cycle, sample.sequence + 1);
  }
  return {q, sample};
}

void stopOrGoOn(test::Random& random, const Controller& controller, ControllerState& state) {
  if (!random.chance(0.005)) return;
  if (state.is_stopping) {
    state.is_stopping = false;
    controller.goOn(controller.initialGains(), state);
  } else {
    state.is_stopping = true;
    if (random.chance(0.5)) {
      state.retreat.velocity_at_fault = state.velocity_before;
      controller.beginRetreat(controller.initialGains(), state);
      state.retreat.is_under_way = true;
    }
  }
}

TEST(ClearController, KeepsItWhateverHappens) {
  test::Random random(421);
  const char* const wanted_runs = std::getenv("TACTUS_CLEARANCE_RUNS");
  const int runs = wanted_runs ? std::atoi(wanted_runs) : 150;
  int close = 0;
  for (int run = 0; run < runs; ++run) {
    const ControllerConfig config = clearController(random);
    const Controller controller(config);
    const BodyDistances distances(config.chain, *config.clearance);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    TactileSample sample;
    double t_s = 0.0, least_m = kNoLimit;
    for (int cycle = 0; cycle < 600; ++cycle) {
      stopOrGoOn(random, controller, state);
      controller.update(pushed(random, cycle, state.q_desired, sample), config.gains, t_s, 0.001,
                        state, output);
      if (!state.is_stopping) t_s += 0.001;
      ChainPose pose;
      config.chain.computePose(state.q_desired, pose);
      least_m = std::min(least_m, nearestBody(distances, pose).distance_m);
      ASSERT_GE(least_m, config.clearance->safe_distance_m - 1e-12) << run << " cycle " << cycle;
      ASSERT_EQ(output.fault, Fault::kNone);
    }
    close += least_m < config.clearance->safe_distance_m + 5e-3 ? 1 : 0;
  }
  EXPECT_GT(close, runs / 20);
}

TEST(ClearController, PreparesTheSameToTheBit) {
  test::Random random(422);
  for (int run = 0; run < 20; ++run) {
    const ControllerConfig config = clearController(random);
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerState other = state;
    ControllerOutput output, other_output;
    PreparedCycle prepared;
    TactileSample sample;
    for (int cycle = 0; cycle < 300; ++cycle) {
      const double t_s = 0.001 * cycle;
      const RobotInput input = pushed(random, cycle, state.q_desired, sample);
      controller.update(input, config.gains, t_s, 0.001, state, output);
      controller.update(input, config.gains, t_s, 0.001, prepared, other, other_output);
      controller.prepare(config.gains, t_s + 0.001, other, prepared);
      test::expectSame(output, other_output);
    }
  }
}

/// As long as nothing is touched, the law of contacts has no say in how the arm keeps clear.
TEST(ClearController, KeepsClearOfWhatItNeverTouchesAsWithoutALaw) {
  test::Random random(432);
  int slowed = 0;
  for (int run = 0; run < 60; ++run) {
    ControllerConfig config = clearController(random);
    while (config.force_control->variant != Variant::kNullLimit) config = clearController(random);
    ControllerConfig lawless = config, anywhere = config;
    lawless.force_control.reset();
    anywhere.clearance.reset();
    const Controller with(config), without(lawless), free(anywhere);
    ControllerState state = with.initialState(), other = without.initialState();
    ControllerState free_state = free.initialState();
    ControllerOutput output, other_output, free_output;
    for (int cycle = 0; cycle < 200; ++cycle) {
      const double t_s = 0.001 * cycle;
      const TactileSample sample = test::touchAt(0.2, 0.0, 0.0, cycle + 1);
      with.update({state.q_desired, sample}, config.gains, t_s, 0.001, state, output);
      without.update({other.q_desired, sample}, config.gains, t_s, 0.001, other, other_output);
      free.update({free_state.q_desired, sample}, config.gains, t_s, 0.001, free_state,
                  free_output);
      const double tolerance = 1e-9 * (1.0 + other_output.velocity.norm());
      ASSERT_NEAR((output.velocity - other_output.velocity).norm(), 0.0, tolerance)
          << run << " cycle " << cycle;
    }
    slowed += (state.q_desired - free_state.q_desired).norm() > 1e-3;
  }
  EXPECT_GT(slowed, 10) << "this test is blind";
}

constexpr double kAvoid_m = 0.06;

/// What is lacking of all distances to kAvoid_m, squared, where a run ends that only holds its
/// tool.
double lackAtTheEnd(const ControllerConfig& config) {
  const Controller controller(config);
  const BodyDistances distances(config.chain, *config.clearance);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int cycle = 0; cycle < 2000; ++cycle)
    controller.update({state.q_desired, {}}, config.gains, 0.0, 0.001, state, output);
  EXPECT_LT(output.error.norm(), 1e-4);
  ChainPose pose;
  config.chain.computePose(state.q_desired, pose);
  double lack = 0.0;
  for (int i = 0; i < distances.size(); ++i) {
    const double lack_m = std::max(0.0, kAvoid_m - distances.distance_m(pose, i));
    lack += lack_m * lack_m;
  }
  return lack;
}

TEST(ClearController, AvoidsInTheNullSpace) {
  test::Random random(423);
  int helped = 0, all = 0;
  for (int run = 0; run < 60; ++run) {
    ControllerConfig config = test::randomController(random, 9, 3);
    config.task.components = {0, 1, 2};
    config.clearance = test::randomBodies(random, 9);
    ClearanceConfig& clearance = *config.clearance;
    clearance.safe_distance_m = 0.005;
    clearance.influence_distance_m = 0.01;
    clearance.avoid = {kAvoid_m, 5.0};
    test::leaveOutTouching(config.chain, config.q_start, clearance);
    const double with = lackAtTheEnd(config);
    clearance.avoid.reset();
    const double without = lackAtTheEnd(config);
    EXPECT_LT(with, 1.001 * without + 1e-9);
    if (without < 1e-4) continue;
    ++all;
    helped += with < 0.9 * without ? 1 : 0;
  }
  EXPECT_GT(all, 10);
  EXPECT_GT(helped, 3 * all / 4);
}

/// A law must not ask for more and more of what the gate does not let it do.
TEST(ClearController, TellsTheLawWhatIsTakenFromItsRetreat) {
  test::Random random(431);
  int taken = 0;
  for (int i = 0; i < 200; ++i) {
    ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
    config.limits.max_acceleration.setConstant(1e9);
    config.limits.max_velocity.setConstant(1e3);
    ControllerConfig clear = config;
    ClearanceConfig& bodies = clear.clearance.emplace();
    bodies.safe_distance_m = 0.02;
    bodies.influence_distance_m = 0.1;
    LinkCapsule& ball = bodies.capsules.emplace_back();
    ball.link.joint = random.integer(3, 8);
    ball.radius_m = 0.05;
    ChainPose pose;
    config.chain.computePose(config.q_start, pose);
    const auto normal = random.unitVector();
    bodies.walls = {HalfSpace{framePosition(pose, ball.link) - 0.0712 * normal, normal}};
    bodies.wall_pairs = {{0, 0}};
    const Controller free(config), kept(clear);
    ControllerState free_state = free.initialState(), kept_state = kept.initialState();
    ControllerOutput free_output, kept_output;
    const RobotInput input{config.q_start, test::touchAt(0.2, 20.0, random.uniform(-3.0, 3.0), 1)};
    free.update(input, config.gains, 0.0, 1e-3, free_state, free_output);
    kept.update(input, config.gains, 0.0, 1e-3, kept_state, kept_output);
    const AttachedFrame& link = config.tactile_modules.front().link;
    const PlacedContact at = placed(pose, link, kept_output.sensed[0]);
    ScaledVector a;
    applyPointJacobianTranspose(config.chain, pose, link.joint, at.p_Base, at.F_Base, a);
    const double cut = a.head(9).dot(free_output.velocity - kept_output.velocity);
    EXPECT_NEAR(kept_state.contact.cut_by_rows_m_per_s, std::max(0.0, cut), 1e-9);
    taken += cut > 1e-3;
    ControllerState stopped = kept.initialState();
    stopped.is_stopping = true;
    kept.update(input, config.gains, 0.0, 1e-3, stopped, kept_output);
    EXPECT_EQ(stopped.contact.cut_by_rows_m_per_s, 0.0) << "nothing is asked of an arm that stops";
  }
  EXPECT_GT(taken, 20);
}

}  // namespace
}  // namespace tactus
