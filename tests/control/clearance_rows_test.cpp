#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "support/rail_robot.h"
#include "support/task_kinematics.h"
#include "tactus/control/clearance.h"
#include "tactus/control/clearance_cost.h"
#include "tactus/control/joint_limit_rows.h"
#include "tactus/control/motion_gate.h"

/// The rows of clearance.h and joint_limit_rows.h by hand: a ball on a rail before a wall.
namespace tactus {
namespace {

constexpr double kRail_s = 0.001;
constexpr double kBall_m = 0.05;
constexpr double kWall_m = 1.0;
constexpr double kSafe_m = 0.02;
constexpr double kInfluence_m = 0.1;

/// d = kWall_m - kBall_m - q_0
struct RailBeforeAWall {
  explicit RailBeforeAWall(double influence_m = kInfluence_m) : config{.chain = test::railChain()} {
    config.q_start = JointVector::Zero(2);
    config.limits = test::noLimits(2);
    config.limits.max_acceleration.setConstant(0.2);
    ClearanceConfig& clear = config.clearance.emplace();
    LinkCapsule ball;
    ball.link.joint = 0;
    ball.radius_m = kBall_m;
    clear.capsules = {ball};
    clear.walls = {HalfSpace{kWall_m * Vector3::UnitY(), -Vector3::UnitY()}};
    clear.wall_pairs = {{0, 0}};
    clear.safe_distance_m = kSafe_m;
    clear.influence_distance_m = influence_m;
    inv_sqrt = scaled(JointVector{{0.5, 2.0}}, ScaledVector::Ones());
  }
  JointVector at(double distance_m) const {
    return JointVector{{kWall_m - kBall_m - distance_m, 0.0}};
  }
  void look(const Clearance& clearance, const JointVector& q) {
    test::computeTaskKinematics(config.chain, q, {1}, inv_sqrt, kinematics);
    clearance.findNear(kinematics.pose, kinematics.near);
  }
  /// The gate of an arm there, whose task is its tip.
  MotionGate gateAt(double distance_m) {
    config.task.size = 1;
    MotionGate gate(config, inv_sqrt);
    look(*gate.clearance(), at(distance_m));
    return gate;
  }
  SpeedRows rows(double distance_m, double velocity_before = 0.0) {
    const Clearance clearance(config);
    const JointVector q = at(distance_m);
    look(clearance, q);
    SpeedRows rows;
    clearance.add(kinematics.near, kinematics, inv_sqrt, q, JointVector{{velocity_before, 0.0}},
                  kRail_s, rows);
    return rows;
  }
  bool isKept(double distance_m, double speed) {
    const Clearance clearance(config);
    const JointVector q = at(distance_m);
    look(clearance, q);
    ScaledVector velocity = ScaledVector::Zero();
    velocity[0] = speed;
    return clearance.isKept(kinematics.pose, kinematics.near, velocity, q, JointVector::Zero(2),
                            kRail_s);
  }

  ControllerConfig config;
  ScaledVector inv_sqrt;
  TaskKinematics kinematics;
};

TEST(ClearanceRows, AreThoseOfTheEquation) {
  RailBeforeAWall rail;
  for (const double d : {0.099, 0.06, 0.03, 0.022}) {
    const SpeedRows rows = rail.rows(d);
    ASSERT_EQ(rows.size, 1) << d;
    const SpeedRow& row = rows.row[0];
    const double presence = (kInfluence_m - d) / (kInfluence_m - kSafe_m);
    EXPECT_NEAR(row.presence, presence, 1e-12);
    EXPECT_NEAR(row.v_max_m_per_s, 5.0 * (d - kSafe_m - 0.001) / presence, 1e-12) << d;
    EXPECT_NEAR(row.damping_N_s_per_m, 2e6, 1e-6);
    EXPECT_NEAR(row.a_scaled[0], -0.5, 1e-15) << "away from the wall, and scaled";
    EXPECT_EQ(row.a_scaled[1], 0.0);
    EXPECT_LT((row.a_task - rail.kinematics.pseudoinverse.project(row.a_scaled)).norm(), 1e-15);
  }
  EXPECT_EQ(rail.rows(kInfluence_m + 1e-9).size, 0);
  EXPECT_EQ(rail.kinematics.near.size, 0) << "nobody has to look at it";
  rail.config.clearance->avoid = {0.3, 1.0};
  EXPECT_EQ(rail.rows(0.2).size, 0) << "near enough to be avoided alone";
  EXPECT_TRUE(rail.isKept(0.2, 9.0));
}

TEST(ClearanceRows, PressBackWhereTheMarginIsLost) {
  RailBeforeAWall rail;
  const double presence = (kInfluence_m - 0.0205) / (kInfluence_m - kSafe_m);
  EXPECT_NEAR(rail.rows(0.0205).row[0].v_max_m_per_s, -5.0 * 0.0005 * presence, 1e-12);
  EXPECT_EQ(rail.rows(0.01).row[0].presence, 1.0) << "no more than all of it";
}

TEST(ClearanceRows, HaveATenthOfTheWayForAMarginWhereThatIsLess) {
  RailBeforeAWall rail(kSafe_m + 0.005);
  EXPECT_NEAR(rail.rows(0.022).row[0].v_max_m_per_s, 5.0 * (0.022 - kSafe_m - 0.0005) / 0.6, 1e-12);
}

/// An arm that takes longer to stop than 1 / gamma comes no faster than it can stop.
TEST(ClearanceRows, KnowTheTimeOfTheStop) {
  RailBeforeAWall rail;
  const double d = 0.06, presence = 0.5;
  // 0.1 m/s at 0.2 m/s^2: 500 cycles, which add up to 250.5.
  EXPECT_NEAR(rail.rows(d, -0.1).row[0].v_max_m_per_s, (d - kSafe_m - 0.001) / 0.2505 / presence,
              1e-12);
  EXPECT_NEAR(rail.rows(d, 0.01).row[0].v_max_m_per_s, 5.0 * 0.039 / presence, 1e-12);
}

TEST(ClearanceRows, AreKeptByWhatGoesNoFaster) {
  RailBeforeAWall rail;
  const double v_max = 5.0 * (0.06 - kSafe_m - 0.001) / 0.5;
  EXPECT_TRUE(rail.isKept(0.06, 0.999 * v_max));
  EXPECT_FALSE(rail.isKept(0.06, 1.001 * v_max));
  EXPECT_TRUE(rail.isKept(0.06, -9.0)) << "away from it";
  EXPECT_TRUE(rail.isKept(0.2, 9.0)) << "far from it";
  const double back = 5.0 * 0.0005 * (kInfluence_m - 0.0205) / (kInfluence_m - kSafe_m);
  EXPECT_FALSE(rail.isKept(0.0205, 0.0)) << "the margin is lost";
  EXPECT_FALSE(rail.isKept(0.0205, -0.999 * back));
  EXPECT_TRUE(rail.isKept(0.0205, -1.001 * back));
  EXPECT_FALSE(rail.isKept(0.06, std::numeric_limits<double>::quiet_NaN()));
}

/// Also far from all bodies, where the gate looks at nothing else.
TEST(ClearanceRows, AreNotAllThatTheGateKeeps) {
  RailBeforeAWall rail;
  const MotionGate gate = rail.gateAt(0.5);
  const JointVector q = rail.at(0.5), rest = JointVector::Zero(2);
  for (const double v_max : {0.1, -0.1}) {  // of an approach, and of a way back
    for (const double excess : {-0.01, 0.01}) {
      SpeedRows rows;
      SpeedRow& contact = rows.row[rows.size++];
      contact.a_scaled = rail.inv_sqrt.cwiseProduct(-ScaledVector::Unit(0));
      contact.a_task = rail.kinematics.pseudoinverse.project(contact.a_scaled);
      contact.v_max_m_per_s = v_max;
      contact.damping_N_s_per_m = contact.presence = 1.0;
      Motion motion;
      motion.y.setZero();
      motion.v_scaled = (v_max + excess) / rail.inv_sqrt[0] * ScaledVector::Unit(0);
      const RowVector l = gate.keep({q, rest, true}, rail.kinematics, 1.0, kRail_s, rows, motion);
      EXPECT_EQ(l[0] > 0.0, excess > 0.0);
      EXPECT_NEAR(speedAlong(rows.row[0], 1, motion), -v_max - std::min(excess, 0.0), 1e-6);
    }
  }
}

/// Nor are those of contacts: a joint near its limit is slowed far from all bodies as well.
TEST(ClearanceRows, AreKeptWithThoseOfJointLimits) {
  RailBeforeAWall rail;
  rail.config.limits.lower.setConstant(-2.0);
  rail.config.limits.upper.setConstant(2.0);
  const JointVector q{{-2.0 + 0.1, 0.0}}, rest = JointVector::Zero(2);
  MotionGate gate = rail.gateAt(0.5);
  rail.look(*gate.clearance(), q);
  ASSERT_EQ(rail.kinematics.near.size, 0);
  const double allowed = std::min(5.0 * 0.1, std::sqrt(0.2 * 0.1)) / (1.0 - 0.1 / 0.25);
  for (const double speed : {0.9 * allowed, 1.5 * allowed, 10.0 * allowed}) {
    SpeedRows rows;
    Motion motion;
    motion.y.setZero();
    motion.v_scaled = -speed / rail.inv_sqrt[0] * ScaledVector::Unit(0);
    // No share of the joints' is asked for where an arm keeps clear.
    gate.keep({q, rest, true}, rail.kinematics, 0.1, kRail_s, rows, motion);
    const ScaledVector velocity = rail.inv_sqrt.cwiseProduct(
        motion.v_scaled + rail.kinematics.pseudoinverse.expand(motion.y));
    EXPECT_NEAR(velocity[0], -std::min(speed, allowed), 1e-6 * allowed);
  }
}

/// Of all of the motion: what the task asks for comes near a wall as well.
TEST(ClearanceRows, AreKeptByTheTask) {
  RailBeforeAWall rail;
  const MotionGate gate = rail.gateAt(0.06);
  const JointVector q = rail.at(0.06), rest = JointVector::Zero(2);
  const WeightedPseudoinverse& J = rail.kinematics.pseudoinverse;
  const double v_max = 5.0 * (0.06 - kSafe_m - 0.001) / 0.5;
  for (const double speed : {0.9 * v_max, 1.2 * v_max, -1.2 * v_max}) {
    SpeedRows rows;
    Motion motion;
    motion.v_scaled.setZero();
    motion.y = J.project(ScaledVector::Unit(0));
    motion.y *= speed / (rail.inv_sqrt[0] * J.expand(motion.y)[0]);
    gate.keep({q, rest, true}, rail.kinematics, 1.0, kRail_s, rows, motion);
    const ScaledVector velocity = rail.inv_sqrt.cwiseProduct(motion.v_scaled + J.expand(motion.y));
    EXPECT_NEAR(velocity[0], std::min(speed, v_max), 1e-6 * v_max);
  }
}

/// The largest share that can still be stopped, found to a thirty-second, between the stop of the
/// velocity before and what is wanted.
TEST(ClearanceRows, HoldBackNoMoreThanIsNeeded) {
  RailBeforeAWall rail;
  rail.config.limits.max_acceleration.setConstant(1e6);
  const Clearance clearance(rail.config);
  for (int i = 1; i < 40; ++i) {
    const double d = kSafe_m + 0.002 * i;
    const JointVector q = rail.at(d);
    rail.look(clearance, q);
    const JointVector rest = JointVector::Zero(2);
    JointVector v{{60.0, 3.0}};
    clearance.holdBack(rail.kinematics.pose, rail.kinematics.near, q, rest, kRail_s, v);
    const double most = std::min(1.0, (d - kSafe_m) / (60.0 * kRail_s));
    EXPECT_LE(v[0], 60.0 * most * (1.0 + 1e-12)) << i;
    EXPECT_GT(v[0], 60.0 * (most - 1.0 / 32.0) - 1e-9) << i;
    EXPECT_NEAR(v[1], v[0] / 20.0, 1e-12) << "all joints together";
    const double steps = v[0] / 60.0 * 32.0;
    EXPECT_TRUE(v[0] == 60.0 || std::abs(steps - std::round(steps)) < 1e-9) << steps;
  }
}

/// Once nothing can pass, what goes on is the stop that is known to be clear.
TEST(ClearanceRows, HoldBackToTheStop) {
  RailBeforeAWall rail;
  const Clearance clearance(rail.config);
  const JointVector q = rail.at(kSafe_m + 1e-9);
  rail.look(clearance, q);
  for (const double before : {0.1, 1e-4}) {
    JointVector v{{0.3, 0.2}};
    const JointVector velocity_before{{before, 0.0}};
    clearance.holdBack(rail.kinematics.pose, rail.kinematics.near, q, velocity_before, kRail_s, v);
    EXPECT_NEAR(v[0], std::max(0.0, before - 0.2 * kRail_s), 1e-12);
    EXPECT_EQ(v[1], 0.0);
  }
}

TEST(ClearanceRows, AskNoStopThatLeavesTheJointsLimits) {
  RailBeforeAWall rail;
  const auto canStop = [&](double q, double v) {
    const Clearance clearance(rail.config);
    const JointVector place{{0.0, q}};
    rail.look(clearance, place);
    return clearance.canStopAfter(rail.kinematics.pose, rail.kinematics.near, place,
                                  JointVector{{0.0, v}}, kRail_s);
  };
  rail.config.limits.lower[1] = -0.5;
  rail.config.limits.upper[1] = 0.5;
  const double way_m = 0.1 * 0.2505;
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(canStop(side * (0.5 - 1.001 * way_m), side * 0.1));
    EXPECT_FALSE(canStop(side * (0.5 - 0.999 * way_m), side * 0.1));
    EXPECT_TRUE(canStop(side * 0.5, 0.0)) << "at rest on the limit";
  }
}

/// gain / l^2 of what is lacking, along the way out, of all that lacks something.
TEST(ClearanceCost, GoesWithWhatIsLacking) {
  RailBeforeAWall rail;
  const Clearance clearance(rail.config);
  const ClearanceAvoidance avoid{0.09, 3.0};
  const auto cost = [&](double distance_m) {
    rail.look(clearance, rail.at(distance_m));
    return clearanceCost(avoid, clearance.distances(), rail.kinematics.pose, rail.kinematics.near,
                         rail.inv_sqrt);
  };
  EXPECT_NEAR(cost(0.06)[0], 3.0 / (0.3 * 0.3) * 0.03 * 0.5, 1e-12);
  EXPECT_EQ(cost(0.06)[1], 0.0);
  EXPECT_TRUE(cost(0.095).isZero(0.0));
}

/// What is left out of the near ones, as it is farther away, may come among them without a jump.
TEST(ClearanceCost, ReachesNoFartherThanWhatIsLeftOut) {
  RailBeforeAWall rail;
  const Clearance clearance(rail.config);
  rail.look(clearance, rail.at(0.06));
  NearBodies& near = rail.kinematics.near;
  const auto cost = [&](double beyond_m) {
    near.beyond_m = beyond_m;
    return clearanceCost({0.09, 3.0}, clearance.distances(), rail.kinematics.pose, near,
                         rail.inv_sqrt)[0];
  };
  EXPECT_NEAR(cost(0.08), 3.0 / (0.3 * 0.3) * 0.02 * 0.5, 1e-12);
  EXPECT_EQ(cost(0.06), 0.0);
  EXPECT_EQ(cost(0.1), cost(0.09));
}

/// d(distance)/dt <= min(gamma left, sqrt(a left)) of a row that stands for a scaled length.
TEST(JointLimitRowsByHand, AreThoseOfTheEquation) {
  RailBeforeAWall rail;
  const Clearance clearance(rail.config);
  rail.config.limits.lower.setConstant(-1.0);
  rail.config.limits.upper.setConstant(1.0);
  rail.config.limits.max_acceleration << 1e12, 0.5;
  const JointVector q{{-0.9, 0.96}};
  rail.look(clearance, JointVector::Zero(2));
  SpeedRows rows;
  JointLimitRows(rail.config.limits, true).add(q, rail.kinematics, rail.inv_sqrt, 0.5, rows);
  ASSERT_EQ(rows.size, 2);
  const double of_first = 5.0 * 0.1, of_second = std::min(5.0 * 0.04, std::sqrt(0.5 * 0.04));
  const double presences[] = {1.0 - 0.1 / 0.25, 1.0 - 0.04 / 0.25};
  EXPECT_NEAR(rows.row[0].a_scaled[0], 0.3, 1e-15);
  EXPECT_NEAR(rows.row[1].a_scaled[1], -0.3, 1e-15);
  EXPECT_NEAR(rows.row[0].v_max_m_per_s, 0.3 / 0.5 * of_first / (0.5 * presences[0]), 1e-12);
  EXPECT_NEAR(rows.row[1].v_max_m_per_s, 0.3 / 2.0 * of_second / (0.5 * presences[1]), 1e-12);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(rows.row[i].presence, presences[i], 1e-12);
    EXPECT_EQ(rows.row[i].damping_N_s_per_m, 2e6);
  }
}

/// What cannot brake so fast comes slower.
TEST(JointLimitRowsByHand, KnowHowFastAJointBrakes) {
  RailBeforeAWall rail;
  const Clearance clearance(rail.config);
  rail.look(clearance, JointVector::Zero(2));
  rail.config.limits.upper.setConstant(1.0);
  rail.config.limits.lower.setConstant(-1.0);
  for (const double acceleration : {0.1, 1e10}) {
    rail.config.limits.max_acceleration.setConstant(acceleration);
    const double left = 0.09;
    SpeedRows rows;
    JointLimitRows(rail.config.limits, false)
        .add(JointVector{{1.0 - left, 0.0}}, rail.kinematics, rail.inv_sqrt, 1.0, rows);
    ASSERT_EQ(rows.size, 1);
    EXPECT_NEAR(rows.row[0].v_max_m_per_s,
                0.3 / 0.5 * std::min(5.0 * left, std::sqrt(acceleration * left)), 1e-12);
    EXPECT_EQ(rows.row[0].presence, 1.0);
  }
}

}  // namespace
}  // namespace tactus
