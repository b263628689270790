#include "tactus/math/tool_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "support/random.h"
#include "tactus/math/rotation.h"

namespace tactus {
namespace {

int toolMotionRuns(int usual) {
  const char* const told = std::getenv("TACTUS_MOTION_RUNS");
  return told ? std::atoi(told) : usual;
}

Pose randomToolPose(test::Random& random) {
  return {random.rotation(), random.vector<Vector3>(3, -1.0, 1.0)};
}

ToolMotionLimits randomToolLimits(test::Random& random) {
  return {{random.logUniform(0.05, 2.0), random.logUniform(0.2, 5.0), random.logUniform(2.0, 50.0)},
          {random.logUniform(0.1, 3.0), random.logUniform(0.5, 9.0), random.logUniform(5.0, 99.0)}};
}

double angleBetween(const Matrix3& a, const Matrix3& b) {
  return rotationVector(a * b.transpose()).norm();
}

TEST(ToolMotion, RestsWhereItIs) {
  test::Random random(3101);
  const Pose X = randomToolPose(random);
  const ToolMotion motion(X);
  for (const double t_s : {0.0, 1.0, 1e5}) {
    const ToolReference reference = motion.evaluate(t_s);
    EXPECT_EQ(reference.p_BaseTool, X.p_AB);
    EXPECT_EQ(reference.R_BaseTool, X.R_AB);
    EXPECT_EQ(reference.v_BaseTool, Vector3(Vector3::Zero()));
    EXPECT_EQ(reference.omega_BaseTool, Vector3(Vector3::Zero()));
  }
}

TEST(ToolMotion, FromRestGoesAlongALineAndAboutAnAxisAtOnce) {
  test::Random random(3102);
  for (int run = 0; run < toolMotionRuns(2000); ++run) {
    const Pose from = randomToolPose(random), to = randomToolPose(random);
    const ToolMotionLimits limits = randomToolLimits(random);
    const double start_s = random.uniform(0.0, 1e4);
    const ToolMotion motion = ToolMotion(from).to(start_s, to, limits);
    const double T = motion.end_s() - start_s;
    const Vector3 line = to.p_AB - from.p_AB;
    const Vector3 turn = rotationVector(to.R_AB * from.R_AB.transpose());
    for (int k = 0; k <= 20; ++k) {
      const double t_s = start_s + T * k / 20.0;
      const ToolReference reference = motion.evaluate(t_s);
      const ToolAcceleration speeding = motion.evaluateAcceleration(t_s);
      const double done = (reference.p_BaseTool - from.p_AB).dot(line) / line.squaredNorm();
      ASSERT_LT((reference.p_BaseTool - from.p_AB - done * line).norm(), 1e-6 * line.norm());
      ASSERT_LT(angleBetween(reference.R_BaseTool, rotationMatrix(done * turn) * from.R_AB),
                1e-5 + 0.17 * turn.norm());
      ASSERT_LE(reference.v_BaseTool.norm(), limits.position.max_speed * (1.0 + 1e-9));
      ASSERT_LE(speeding.a_BaseTool.norm(), limits.position.max_acceleration * (1.0 + 1e-9));
      ASSERT_LE(reference.omega_BaseTool.norm(), limits.rotation.max_speed * (1.0 + 1e-9));
      ASSERT_LE(speeding.alpha_BaseTool.norm(), limits.rotation.max_acceleration * (1.0 + 1e-9));
      ASSERT_LT(reference.omega_BaseTool.cross(turn).norm(), 1e-6 * turn.norm());
    }
    const ToolReference just_before = motion.evaluate(motion.end_s() - 1e-6);
    ASSERT_LT((just_before.p_BaseTool - to.p_AB).norm(), 1e-9);
    ASSERT_LT(angleBetween(just_before.R_BaseTool, to.R_AB), 1e-8);
    const ToolReference end = motion.evaluate(motion.end_s());
    ASSERT_EQ(end.p_BaseTool, to.p_AB);
    ASSERT_LT(angleBetween(end.R_BaseTool, to.R_AB), 1e-12);
    ASSERT_TRUE(end.v_BaseTool.isZero(0.0) && end.omega_BaseTool.isZero(0.0));
  }
}

/// Told anew at any moment: nothing jumps, all limits are kept, and the last target is reached.
TEST(ToolMotion, MayBeToldAnythingAtAnyTime) {
  test::Random random(3103);
  const int runs = toolMotionRuns(3000);
  ToolMotionLimits limits = randomToolLimits(random);
  ToolMotion motion(randomToolPose(random));
  double t_s = 0.0;
  for (int run = 0; run < runs; ++run) {
    if (motion.end_s() <= t_s) limits = randomToolLimits(random);
    const Pose target = randomToolPose(random);
    const ToolMotion next =
        random.chance(0.1) ? motion.stop(t_s, limits) : motion.to(t_s, target, limits);
    const ToolReference was = motion.evaluate(t_s), is = next.evaluate(t_s);
    const ToolAcceleration was_a = motion.evaluateAcceleration(t_s),
                           is_a = next.evaluateAcceleration(t_s);
    ASSERT_LT((was.p_BaseTool - is.p_BaseTool).norm(), 1e-12);
    ASSERT_LT((was.v_BaseTool - is.v_BaseTool).norm(), 1e-12);
    ASSERT_LT((was_a.a_BaseTool - is_a.a_BaseTool).norm(), 1e-12);
    ASSERT_LT(angleBetween(was.R_BaseTool, is.R_BaseTool), 1e-12);
    ASSERT_LT((was.omega_BaseTool - is.omega_BaseTool).norm(), 1e-12);
    ASSERT_LT((was_a.alpha_BaseTool - is_a.alpha_BaseTool).norm(), 1e-11);
    ASSERT_NE(next.plan().number, motion.plan().number);
    motion = next;
    const double T = motion.end_s() - t_s;
    for (int k = 0; k <= 10; ++k) {
      const double at_s = t_s + T * k / 10.0;
      const ToolReference reference = motion.evaluate(at_s);
      const ToolAcceleration speeding = motion.evaluateAcceleration(at_s);
      ASSERT_LE(reference.v_BaseTool.cwiseAbs().maxCoeff(),
                limits.position.max_speed * (1.0 + 1e-9));
      ASSERT_LE(speeding.a_BaseTool.cwiseAbs().maxCoeff(),
                limits.position.max_acceleration * (1.0 + 1e-9));
      // Each axis of the rotation vector; for a while two of them more, where it is counted anew.
      ASSERT_LE(reference.omega_BaseTool.norm(),
                std::sqrt(5.0) * limits.rotation.max_speed * (1.0 + 1e-9));
    }
    const ToolReference end = motion.evaluate(motion.end_s());
    if (motion.plan().kind == ToolMotionPlan::Kind::kGo) {
      ASSERT_EQ(end.p_BaseTool, target.p_AB);
      ASSERT_LT(angleBetween(end.R_BaseTool, target.R_AB), 1e-12);
    }
    t_s += random.chance(0.1) ? T : random.uniform(0.0, T);
  }
}

TEST(ToolMotion, TurnsAsFastAsItsOrientationChanges) {
  test::Random random(3104);
  const double h = 1e-5;
  for (int run = 0; run < toolMotionRuns(500); ++run) {
    const ToolMotionLimits limits = randomToolLimits(random);
    ToolMotion motion = ToolMotion(randomToolPose(random)).to(0.0, randomToolPose(random), limits);
    const double change_s = random.uniform(0.0, motion.end_s());
    motion = motion.to(change_s, randomToolPose(random), limits);  // about no fixed axis from here
    const double t_s = random.uniform(change_s + h, motion.end_s());
    const ToolReference at = motion.evaluate(t_s), before = motion.evaluate(t_s - h),
                        after = motion.evaluate(t_s + h);
    const Vector3 omega =
        rotationVector(after.R_BaseTool * before.R_BaseTool.transpose()) / (2.0 * h);
    ASSERT_LT((omega - at.omega_BaseTool).norm(), 1e-6);
    const Vector3 alpha = (after.omega_BaseTool - before.omega_BaseTool) / (2.0 * h);
    ASSERT_LT((alpha - motion.evaluateAcceleration(t_s).alpha_BaseTool).norm(),
              1e-5 + 2.0 * h * limits.rotation.max_jerk);
  }
}

TEST(ToolMotion, AtATimeThatIsNanIsNowhere) {
  test::Random random(3109);
  const ToolMotion motion =
      ToolMotion(randomToolPose(random)).to(1.0, randomToolPose(random), randomToolLimits(random));
  EXPECT_FALSE(motion.evaluate(std::nan("")).p_BaseTool.allFinite());
}

TEST(ToolMotion, GoesOnStraightAlongItsLine) {
  const ToolMotionLimits limits;
  const Vector3 line(0.3, -0.2, 0.1);
  const Pose start{Matrix3::Identity(), Vector3::Zero()};
  const ToolMotion motion = ToolMotion(start).to(0.0, {Matrix3::Identity(), line}, limits);
  const double t_s = 0.4 * motion.end_s();
  for (const ToolMotion& next :
       {motion.to(t_s, {Matrix3::Identity(), 2.0 * line}, limits), motion.stop(t_s, limits),
        motion.to(t_s, {Matrix3::Identity(), -line}, limits)}) {
    for (int k = 0; k <= 50; ++k) {
      const ToolReference reference = next.evaluate(t_s + (next.end_s() - t_s) * k / 50.0);
      EXPECT_LT(reference.p_BaseTool.cross(line.normalized()).norm(), 1e-9);
      EXPECT_LE(reference.v_BaseTool.norm(), limits.position.max_speed * (1.0 + 1e-9));
    }
  }
}

/// The same target with less speed: no axis goes its own way.
TEST(ToolMotion, SlowsDownAlongItsLine) {
  ToolMotionLimits limits;
  const Pose start{Matrix3::Identity(), Vector3::Zero()}, end{Matrix3::Identity(), {0.3, 0.3, 0.3}};
  const ToolMotion motion = ToolMotion(start).to(0.0, end, limits);
  limits.position.max_speed = 0.05;
  const ToolMotion slower = motion.to(1.0, end, limits);
  EXPECT_NEAR(slower.evaluate(1.0).v_BaseTool.norm(), 0.1, 1e-9);
  for (double t_s = 1.4; t_s < slower.end_s(); t_s += 0.05)
    EXPECT_LE(slower.evaluate(t_s).v_BaseTool.norm(), 0.05 * (1.0 + 1e-9)) << t_s;
}

/// A stream that turns on and on, each target a little ahead.
TEST(ToolMotion, TurnsOnAfterAWholeTurn) {
  ToolMotion motion{Pose{Matrix3::Identity(), Vector3::Zero()}};
  const ToolMotionLimits limits;
  for (int i = 1; i < 2500; ++i) {
    const double t_s = 0.01 * i;
    motion = motion.to(t_s, {rotationMatrix({0.0, 0.0, 0.4 * t_s + 0.1}), Vector3::Zero()}, limits);
    if (i <= 100) continue;
    ASSERT_GT(motion.evaluate(t_s).omega_BaseTool.z(), 0.3) << t_s;
  }
}

/// A plan is all that there is to know, as for a reader of the log.
TEST(ToolMotion, FollowsFromItsPlan) {
  test::Random random(3105);
  const ToolMotionLimits limits;
  const ToolMotion first =
      ToolMotion(randomToolPose(random)).to(0.0, randomToolPose(random), limits);
  const ToolMotion motion = first.to(0.5, randomToolPose(random), limits);
  const ToolMotion again(motion.plan());
  for (int k = 0; k < 50; ++k) {
    const double t_s = 0.5 + 0.1 * k;
    EXPECT_EQ(motion.evaluate(t_s).p_BaseTool, again.evaluate(t_s).p_BaseTool);
    EXPECT_EQ(motion.evaluate(t_s).R_BaseTool, again.evaluate(t_s).R_BaseTool);
    EXPECT_EQ(motion.evaluate(t_s).omega_BaseTool, again.evaluate(t_s).omega_BaseTool);
  }
}

}  // namespace
}  // namespace tactus
