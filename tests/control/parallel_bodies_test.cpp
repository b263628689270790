#include <gtest/gtest.h>

#include <algorithm>

#include "support/random.h"
#include "support/random_limits.h"
#include "tactus/control/clearance_cost.h"
#include "tactus/control/controller.h"

/// Bodies beside a link that are nearly parallel to it, where the nearest point goes from one end
/// to the other within no motion.
namespace tactus {
namespace {

constexpr int kJoints = 5;

/// Five links in the plane, the third of which has a capsule.
ControllerConfig planarArm() {
  std::vector<Joint> joints(kJoints);
  for (Joint& joint : joints) joint.X_ParentJoint.p_AB = 0.3 * Vector3::UnitX();
  joints[0].X_ParentJoint.p_AB.setZero();
  ControllerConfig config{
      .chain = SerialChain(joints, {kJoints - 1, {Matrix3::Identity(), 0.2 * Vector3::UnitX()}})};
  config.q_start = JointVector{{0.3, 0.5, -0.8, 0.4, 0.9}};
  config.weights = JointVector::Ones(kJoints);
  config.limits = test::noLimits(kJoints);
  config.limits.max_velocity.setConstant(3.0);
  config.limits.max_acceleration.setConstant(50.0);
  config.task.size = 2;
  config.task.components[0] = 0;
  config.task.components[1] = 1;
  LinkCapsule link;
  link.link.joint = 2;
  link.p_LinkTo = 0.3 * Vector3::UnitX();
  link.radius_m = 0.02;
  config.clearance.emplace().capsules = {link};
  config.clearance->avoid.emplace();
  return config;
}

/// A post along a direction in the plane, at a distance from a point to its left.
LinkCapsule post(const Vector3& p_Beside, double angle, double left_m, double length_m) {
  const Vector3 along(std::cos(angle), std::sin(angle), 0.0);
  const Vector3 foot = p_Beside + left_m * Vector3(-along[1], along[0], 0.0);
  LinkCapsule post;
  post.link.joint = -1;
  post.p_LinkFrom = foot - 0.5 * length_m * along;
  post.p_LinkTo = foot + 0.5 * length_m * along;
  post.radius_m = 0.01;
  return post;
}

/// Where the third link is at the start.
struct ThirdLink {
  explicit ThirdLink(const JointVector& q)
      : p_Middle(0.3 * (direction(q[0]) + direction(q[0] + q[1])) +
                 0.15 * direction(q[0] + q[1] + q[2])),
        angle(q[0] + q[1] + q[2]) {}
  static Vector3 direction(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

  Vector3 p_Middle;
  double angle;
};

TEST(ParallelBodies, BetweenTwoOfThemALinkComesToRest) {
  for (const double gain_per_s : {0.2, 2.0, 10.0}) {
    for (const double turned : {0.0, 0.03, -0.1, 0.15}) {
      ControllerConfig config = planarArm();
      config.clearance->avoid->gain_per_s = gain_per_s;
      const ThirdLink link(config.q_start);
      for (const double side : {1.0, -1.0}) {
        config.clearance->pairs.push_back({0, static_cast<int>(config.clearance->capsules.size())});
        config.clearance->capsules.push_back(
            post(link.p_Middle, link.angle + turned, side * 0.11, 0.7));
      }
      const Controller controller(config);
      ControllerState state = controller.initialState();
      ControllerOutput output;
      JointVector before = JointVector::Zero(kJoints);
      double step = 0.0, late_step = 0.0;
      for (int cycle = 0; cycle < 20000; ++cycle) {
        controller.update({state.q_desired, {}}, controller.initialGains(), 0.001 * cycle, 0.001,
                          state, output);
        const double change = (output.velocity - before).cwiseAbs().maxCoeff();
        if (cycle > 100) step = std::max(step, change);  // it begins in the midst of it
        if (cycle >= 10000) late_step = std::max(late_step, change);
        before = output.velocity;
      }
      SCOPED_TRACE(testing::Message() << gain_per_s << " " << turned);
      EXPECT_LT(step, 0.02);
      EXPECT_LT(late_step, 1e-6);
      EXPECT_LT(before.cwiseAbs().maxCoeff(), 5e-3) << "rad/s";
    }
  }
}

/// However a body lies, a turn by little changes what it costs by little.
TEST(ParallelBodies, CostAsMuchJustBeforeAndJustAfterTheyAreParallel) {
  test::Random random(905);
  for (int run = 0; run < 2000; ++run) {
    ControllerConfig config = planarArm();
    config.q_start = random.vector(kJoints, -1.0, 1.0);
    const ThirdLink link(config.q_start);
    const double left_m = random.sign() * random.uniform(0.04, 0.15);
    const double along_m = random.uniform(-0.3, 0.3), length_m = random.uniform(0.05, 0.7);
    const double center = random.chance(0.5) ? 0.0 : random.uniform(-0.3, 0.3);
    const auto costOf = [&](double turned) {
      config.clearance->pairs = {{0, 1}};
      config.clearance->capsules.resize(1);
      config.clearance->capsules.push_back(
          post(link.p_Middle + along_m * ThirdLink::direction(link.angle),
               link.angle + center + turned, left_m, length_m));
      const BodyDistances distances(config.chain, *config.clearance);
      ChainPose pose;
      config.chain.computePose(config.q_start, pose);
      NearBodies near;
      distances.findNear(pose, 0.15, near);
      return ScaledVector(clearanceCost(*config.clearance->avoid, distances, pose, near,
                                        scaled(JointVector::Ones(kJoints), ScaledVector::Ones())));
    };
    ASSERT_LT((costOf(1e-7) - costOf(-1e-7)).norm(), 1e-4) << run;
  }
}

}  // namespace
}  // namespace tactus
