#include "tactus/control/stopping_way.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/random_clearance.h"

namespace tactus {
namespace {

constexpr double kWay_s = 0.001;
constexpr double kApart_m = 0.5;

/// Joints one behind the other along x: revolute ones turn about z, prismatic ones slide along x.
ControllerConfig stretchedArm(const std::vector<JointType>& types, double acceleration) {
  const auto n = static_cast<int>(types.size());
  std::vector<Joint> joints(types.size());
  for (int i = 0; i < n; ++i) {
    joints[i].type = types[i];
    joints[i].axis = types[i] == JointType::kPrismatic ? Vector3::UnitX() : Vector3::UnitZ();
    if (i > 0) joints[i].X_ParentJoint.p_AB = kApart_m * Vector3::UnitX();
  }
  ControllerConfig config{.chain = SerialChain(joints, {n - 1, {}})};
  config.q_start = JointVector::Zero(n);
  config.limits = test::noLimits(n);
  config.limits.max_acceleration.setConstant(acceleration);
  return config;
}

LinkCapsule capsuleOf(int joint, double to_m) {
  LinkCapsule capsule;
  capsule.link.joint = joint;
  capsule.p_LinkTo = to_m * Vector3::UnitX();
  capsule.radius_m = 7.0;  // its axis alone counts
  return capsule;
}

constexpr auto kTurns = JointType::kRevolute;
constexpr auto kSlides = JointType::kPrismatic;

TEST(StoppingWay, RampsAsLongAsItsSlowestJointTakes) {
  test::Random random(2201);
  for (int i = 0; i < 500; ++i) {
    const int n = random.integer(2, kMaxJoints);
    ControllerConfig config = stretchedArm(std::vector<JointType>(n, kTurns), 1.0);
    for (double& a : config.limits.max_acceleration) a = random.logUniform(0.1, 100.0);
    const JointVector v = random.vector(n, -3.0, 3.0);
    const double expected_s = v.cwiseAbs().cwiseQuotient(config.limits.max_acceleration).maxCoeff();
    ASSERT_NEAR(StoppingWays(config, {}).ramp_s(v), expected_s, 1e-12 * expected_s) << n;
  }
}

/// The setpoints of the ramp one by one: its way is that of v for time_s.
TEST(StoppingWay, IsTheSumOfItsCycles) {
  test::Random random(2202);
  const StoppingWays ways(stretchedArm({kTurns, kTurns}, 2.0), {});
  for (int i = 0; i < 2000; ++i) {
    const double v = random.chance(0.2) ? 0.002 * random.integer(0, 9) : random.logUniform(1e-5, 2);
    const double cycles = std::abs(v) / 2.0 / kWay_s;
    double time_s = 0.0;
    for (int k = 0; k <= std::max(0.0, cycles); ++k)
      time_s += kWay_s * (k == 0 ? 1.0 : 1.0 - k / cycles);
    const StoppingWay way = ways.of(JointVector::Zero(2), JointVector{{0.0, v}}, kWay_s);
    ASSERT_NEAR(way.time_s, time_s, 1e-11 * time_s) << v;
  }
}

TEST(StoppingWay, BoundsByTheStretchedWayFromEachJointOn) {
  const ControllerConfig config = stretchedArm({kTurns, kTurns}, 1e6);
  const JointVector v{{-0.7, 0.2}};
  const auto way = [&](const std::vector<LinkCapsule>& capsules) {
    return StoppingWays(config, capsules).of(JointVector{{0.3, -0.8}}, v, kWay_s);
  };
  const StoppingWay of_tip = way({capsuleOf(0, 0.4), capsuleOf(1, 0.3), capsuleOf(-1, 9.0)});
  EXPECT_NEAR(of_tip.speed_m_per_s, 0.7 * 0.8 + 0.2 * 0.3, 1e-15);
  EXPECT_NEAR(of_tip.acceleration_m_per_s2, 0.7 * 0.8 * 0.7 + 0.2 * 0.3 * (0.2 + 2.0 * 0.7), 1e-15);
  const StoppingWay of_long = way({capsuleOf(0, -1.1), capsuleOf(1, 0.3)});
  EXPECT_NEAR(of_long.speed_m_per_s, 0.7 * 1.1 + 0.2 * 0.3, 1e-15);
  LinkCapsule turned = capsuleOf(1, 0.4);
  turned.p_LinkFrom = 0.2 * Vector3::UnitX();
  turned.link.X_JointFrame.p_AB = 0.3 * Vector3::UnitY();
  turned.link.X_JointFrame.R_AB =
      Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitZ()).toRotationMatrix();
  EXPECT_NEAR(way({turned}).speed_m_per_s, 0.7 * (0.5 + 0.7) + 0.2 * 0.7, 1e-15);
}

/// Of any number of joints: a capsule that stands in the base moves with none of them.
TEST(StoppingWay, LeavesOutWhatStandsInTheBase) {
  for (int n = 2; n <= kMaxJoints; ++n) {
    const ControllerConfig config = stretchedArm(std::vector<JointType>(n, kTurns), 1e6);
    const JointVector v = JointVector::Ones(n);
    const auto speed = [&](const std::vector<LinkCapsule>& capsules) {
      return StoppingWays(config, capsules).of(JointVector::Zero(n), v, kWay_s).speed_m_per_s;
    };
    const LinkCapsule of_last = capsuleOf(n - 1, 0.3);
    EXPECT_EQ(speed({of_last, capsuleOf(-1, 9.0)}), speed({of_last})) << n;
  }
}

/// A slide behind a joint that turns makes that joint's lever longer, by where it is and by what
/// its stop still adds.
TEST(StoppingWay, LengthensWithASlide) {
  ControllerConfig config = stretchedArm({kTurns, kSlides}, 4.0);
  config.q_start[1] = 0.1;
  const StoppingWays ways(config, {capsuleOf(1, 0.3)});
  for (const double slid_m : {-0.2, 0.0, 0.25}) {
    const JointVector q{{0.4, 0.1 + slid_m}};
    const JointVector v{{1.5, -0.2}};
    const StoppingWay way = ways.of(q, v, kWay_s);
    const double lever_m = 0.5 + 0.1 + 0.3 + std::abs(slid_m) + way.time_s * 0.2;
    EXPECT_NEAR(way.speed_m_per_s, 1.5 * lever_m + 0.2, 1e-14) << slid_m;
    EXPECT_NEAR(way.acceleration_m_per_s2, 1.5 * lever_m * 1.5 + 0.2 * 2.0 * 1.5, 1e-14);
    const SpeedSums sums = ways.speedSums(q, scaled(v, ScaledVector::Ones()));
    EXPECT_EQ(sums[0], 0.0);
    EXPECT_NEAR(sums[1], 1.5 * (0.9 + std::abs(slid_m)), 1e-14);
    EXPECT_NEAR(sums[2], sums[1] + 0.2, 1e-14);
  }
}

TEST(StoppingWay, OfASlideAloneIsStraight) {
  const ControllerConfig config = stretchedArm({kSlides, kTurns}, 1e6);
  const StoppingWays ways(config, {capsuleOf(1, 0.3)});
  const JointVector v{{-0.5, 2.0}};
  const StoppingWay way = ways.of(JointVector{{9.0, 1.0}}, v, kWay_s);
  EXPECT_NEAR(way.speed_m_per_s, 0.5 + 2.0 * 0.3, 1e-15);
  EXPECT_NEAR(way.acceleration_m_per_s2, 2.0 * 0.3 * 2.0, 1e-15);
  const SpeedSums sums = ways.speedSums(JointVector{{9.0, 1.0}}, scaled(v, ScaledVector::Ones()));
  EXPECT_NEAR(sums[1], 0.5, 1e-15);
  EXPECT_NEAR(sums[2], 0.5 + 0.6, 1e-15);
}

/// Of any arm: no end of a capsule moves faster, or bends its way more, by differences.
TEST(StoppingWay, BoundsWhatAnyPointDoes) {
  test::Random random(2203);
  constexpr double h = 1e-4;
  for (int i = 0; i < 300; ++i) {
    const int n = random.integer(2, 9);
    ControllerConfig config = test::randomController(random, n, 1);
    config.limits.max_acceleration.setConstant(10.0);
    std::vector<LinkCapsule> capsules;
    for (int joint = 0; joint < n; ++joint) capsules.push_back(test::randomCapsule(random, joint));
    const JointVector q = config.q_start + random.vector(n, -0.5, 0.5);
    const JointVector v = random.vector(n, -1.0, 1.0);
    const StoppingWay way = StoppingWays(config, capsules).of(q, v, kWay_s);
    const double tau = random.uniform(0.0, way.time_s);
    for (const LinkCapsule& capsule : capsules) {
      const auto end = [&](double t_s) {
        ChainPose pose;
        config.chain.computePose(q + t_s * v, pose);
        const Pose X = framePose(pose, capsule.link);
        return Vector3(X.p_AB + X.R_AB * capsule.p_LinkTo);
      };
      ASSERT_LE((end(h) - end(-h)).norm() / (2.0 * h), way.speed_m_per_s * (1.0 + 1e-6)) << i;
      ASSERT_LE((end(tau + h) - 2.0 * end(tau) + end(tau - h)).norm() / (h * h),
                way.acceleration_m_per_s2 * (1.0 + 1e-6) + 1e-6)
          << i;
    }
  }
}

}  // namespace
}  // namespace tactus
