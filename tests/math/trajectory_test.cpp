#include "tactus/math/trajectory.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tactus {
namespace {

Pose startPose(test::Random& random) {
  return {random.rotation(), random.vector<Vector3>(3, -1.0, 1.0)};
}

Waypoint straight(const Vector3& displacement_m, double speed_m_per_s, double ramp_s) {
  Waypoint waypoint;
  waypoint.displacement_m = displacement_m;
  waypoint.speed_m_per_s = speed_m_per_s;
  waypoint.ramp_s = ramp_s;
  return waypoint;
}

TrajectoryConfig randomPath(test::Random& random) {
  TrajectoryConfig config;
  config.start_s = random.uniform(0.0, 1.0);
  for (int i = random.integer(1, 4); i > 0; --i) {
    Waypoint waypoint = straight(random.vector<Vector3>(3, -0.5, 0.5), random.logUniform(0.05, 2.0),
                                 random.logUniform(0.05, 1.0));
    if (random.chance(0.2)) waypoint.displacement_m *= 1e-3;  // too short for the cruise speed
    waypoint.pause_s = random.chance(0.5) ? random.uniform(0.0, 0.5) : 0.0;
    if (random.chance(0.7))
      waypoint.rotation_vector_rad = random.uniform(0.0, 1.5) * random.unitVector();
    config.waypoints.push_back(waypoint);
  }
  return config;
}

TEST(Trajectory, WithoutWaypointsHoldsTheStartPose) {
  test::Random random(101);
  const Pose X = startPose(random);
  const Trajectory trajectory({}, X);
  for (const double t_s : {-1.0, 0.0, 0.3, 1e6}) {
    const ToolReference reference = trajectory.evaluate(t_s);
    EXPECT_EQ(reference.p_BaseTool, X.p_AB);
    EXPECT_EQ(reference.R_BaseTool, X.R_AB);
    EXPECT_EQ(reference.v_BaseTool, Vector3(Vector3::Zero()));
    EXPECT_EQ(reference.omega_BaseTool, Vector3(Vector3::Zero()));
  }
}

TEST(Trajectory, FollowsThePapersLineComputedByHand) {
  // 0.4436 m at 0.0537 m/s, ramps of 0.5 s, from 0.5 s: cruise 8.2607 s, end at 9.2607 s.
  const Trajectory trajectory({0.5, {straight({0.0, 0.4436, 0.0}, 0.0537, 0.5)}}, Pose{});
  EXPECT_NEAR(trajectory.end_s(), 0.5 + 0.4436 / 0.0537 + 0.5, 1e-12);
  EXPECT_EQ(trajectory.evaluate(0.5).v_BaseTool.y(), 0.0);
  EXPECT_NEAR(trajectory.evaluate(0.75).v_BaseTool.y(), 0.5 * 0.0537, 1e-15);
  // Half of the ramp: 0.25 of its time at mean speed 1/2, less T/(2 pi).
  EXPECT_NEAR(trajectory.evaluate(0.75).p_BaseTool.y(), 0.0537 * (0.125 - 0.25 / M_PI), 1e-15);
  EXPECT_NEAR(trajectory.evaluate(1.0).p_BaseTool.y(), 0.0537 * 0.25, 1e-15);
  EXPECT_NEAR(trajectory.evaluate(3.0).v_BaseTool.y(), 0.0537, 1e-15);
  EXPECT_NEAR(trajectory.evaluate(3.0).p_BaseTool.y(), 0.0537 * 2.25, 1e-15);
  EXPECT_NEAR(trajectory.evaluate(20.0).p_BaseTool.y(), 0.4436, 1e-15);
  EXPECT_EQ(trajectory.evaluate(20.0).v_BaseTool.y(), 0.0);
}

TEST(Trajectory, VelocityIsTheDerivativeOfPosition) {
  test::Random random(102);
  for (int i = 0; i < 100; ++i) {
    const Trajectory trajectory(randomPath(random), startPose(random));
    for (int k = 0; k < 50; ++k) {
      const double t_s = random.uniform(-0.2, trajectory.end_s() + 0.5);
      const double h = 1e-5;
      const ToolReference before = trajectory.evaluate(t_s - h);
      const ToolReference now = trajectory.evaluate(t_s);
      const ToolReference after = trajectory.evaluate(t_s + h);
      const Vector3 v = (after.p_BaseTool - before.p_BaseTool) / (2.0 * h);
      ASSERT_LT((v - now.v_BaseTool).norm(), 1e-5) << t_s;
      const Matrix3 turn = (after.R_BaseTool * before.R_BaseTool.transpose());
      const Vector3 omega =
          Vector3(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)) /
          (4.0 * h);
      ASSERT_LT((omega - now.omega_BaseTool).norm(), 1e-4) << t_s;
    }
  }
}

TEST(Trajectory, AccelerationHasNoJumps) {
  test::Random random(103);
  constexpr double h = 1e-4;
  for (int i = 0; i < 30; ++i) {
    const TrajectoryConfig config = randomPath(random);
    const Trajectory trajectory(config, startPose(random));
    double max_jerk = 0.0;  // of a sin^2 ramp: v pi^2 / (2 T^2)
    for (const Waypoint& waypoint : config.waypoints)
      max_jerk = std::max(max_jerk, waypoint.speed_m_per_s * 4.94 / std::pow(waypoint.ramp_s, 2));
    Vector3 acceleration_before = Vector3::Zero();
    for (double t_s = 0.0; t_s < trajectory.end_s() + 0.1; t_s += h) {
      const Vector3 acceleration =
          (trajectory.evaluate(t_s + h).v_BaseTool - trajectory.evaluate(t_s).v_BaseTool) / h;
      ASSERT_LT((acceleration - acceleration_before).norm(), max_jerk * h * 1.01 + 1e-9) << t_s;
      acceleration_before = acceleration;
    }
  }
}

TEST(Trajectory, TellsHowItsVelocitiesChange) {
  test::Random random(105);
  constexpr double kStep_s = 1e-6;
  double largest = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Trajectory trajectory(randomPath(random), startPose(random));
    for (int k = 0; k < 100; ++k) {
      const double t_s = random.uniform(-0.1, trajectory.end_s() + 0.1);
      const ToolReference before = trajectory.evaluate(t_s - kStep_s);
      const ToolReference after = trajectory.evaluate(t_s + kStep_s);
      const ToolAcceleration a = trajectory.evaluateAcceleration(t_s);
      const double bound = 1e-7 + 1e-3 * a.a_BaseTool.norm() + 1e-3 * a.alpha_BaseTool.norm();
      ASSERT_LT(((after.v_BaseTool - before.v_BaseTool) / (2.0 * kStep_s) - a.a_BaseTool).norm(),
                1e-3 + bound);
      ASSERT_LT(
          ((after.omega_BaseTool - before.omega_BaseTool) / (2.0 * kStep_s) - a.alpha_BaseTool)
              .norm(),
          1e-3 + bound);
      largest = std::max(largest, a.a_BaseTool.norm());
    }
  }
  EXPECT_GT(largest, 1.0);
}

TEST(Trajectory, RestsAtEveryCornerAndDuringPauses) {
  Waypoint there = straight({0.3, 0.0, 0.0}, 0.1, 0.2);
  there.pause_s = 0.7;
  const Waypoint back = straight({0.0, 0.2, 0.0}, 0.2, 0.1);
  const Trajectory trajectory({1.0, {there, back}}, Pose{});
  const double corner_s = 1.0 + 3.0 + 0.2;
  for (const double t_s : {corner_s, corner_s + 0.3, corner_s + 0.7}) {
    EXPECT_LT((trajectory.evaluate(t_s).p_BaseTool - Vector3(0.3, 0.0, 0.0)).norm(), 1e-12);
    EXPECT_LT(trajectory.evaluate(t_s).v_BaseTool.norm(), 1e-12);
  }
  EXPECT_GT(trajectory.evaluate(corner_s + 0.8).v_BaseTool.norm(), 0.01) << "the pause is over";
  // The second leg goes to (0, 0.2, 0) from the *start* pose: its length is hypot(0.3, 0.2).
  EXPECT_NEAR(trajectory.end_s(), corner_s + 0.7 + std::hypot(0.3, 0.2) / 0.2 + 0.1, 1e-12);
  EXPECT_LT((trajectory.evaluate(100.0).p_BaseTool - Vector3(0.0, 0.2, 0.0)).norm(), 1e-12);
}

TEST(Trajectory, NeverExceedsItsSpeedsAndArrives) {
  test::Random random(104);
  for (int i = 0; i < 100; ++i) {
    const TrajectoryConfig config = randomPath(random);
    const Pose X = startPose(random);
    const Trajectory trajectory(config, X);
    double max_speed = 0.0;
    double max_turn = 0.0;
    for (const Waypoint& waypoint : config.waypoints) {
      max_speed = std::max(max_speed, waypoint.speed_m_per_s);
      max_turn = std::max(max_turn, waypoint.angular_speed_rad_per_s);
    }
    for (double t_s = 0.0; t_s < trajectory.end_s(); t_s += 0.003) {
      ASSERT_LE(trajectory.evaluate(t_s).v_BaseTool.norm(), max_speed * (1.0 + 1e-12));
      ASSERT_LE(trajectory.evaluate(t_s).omega_BaseTool.norm(), max_turn * (1.0 + 1e-12));
    }
    const Waypoint& last = config.waypoints.back();
    const ToolReference end = trajectory.evaluate(trajectory.end_s());
    ASSERT_LT((end.p_BaseTool - X.p_AB - last.displacement_m).norm(), 1e-12);
    const double angle = last.rotation_vector_rad.norm();
    const Matrix3 turn =
        angle == 0.0
            ? Matrix3(Matrix3::Identity())
            : Eigen::AngleAxisd(angle, last.rotation_vector_rad / angle).toRotationMatrix();
    ASSERT_LT((end.R_BaseTool - turn * X.R_AB).norm(), 1e-12) << "rotation is about base axes";
  }
}

TEST(Trajectory, ShortPathsKeepTheirRampsAndStaySlow) {
  // 1 mm at up to 1 m/s with ramps of 0.5 s: a single hump of 1 s with a peak of 2 mm/s.
  const Trajectory trajectory({0.0, {straight({0.001, 0.0, 0.0}, 1.0, 0.5)}}, Pose{});
  EXPECT_NEAR(trajectory.end_s(), 1.0, 1e-12);
  EXPECT_NEAR(trajectory.evaluate(0.5).v_BaseTool.x(), 0.002, 1e-15);
  EXPECT_NEAR(trajectory.evaluate(0.5).p_BaseTool.x(), 0.0005, 1e-15);
}

}  // namespace
}  // namespace tactus
