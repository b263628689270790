#include "tactus/math/velocity_product.h"

#include <gtest/gtest.h>

#include "support/expanded_pseudoinverse.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

/// A point of any link of a random robot in motion.
struct MovingPoint {
  explicit MovingPoint(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        joints(test::randomJoints(random, n)),
        frame(test::randomFrame(random, random.integer(0, n - 1))),
        chain(joints, frame),
        q(random.vector(n, -3.0, 3.0)),
        q_dot(random.vector(n, -1.0, 1.0)) {}

  VelocityProduct product() const {
    ChainPose pose;
    chain.computePose(q, pose);
    return velocityProduct(chain, pose, frame.joint, framePosition(pose, frame), q_dot);
  }

  /// Velocity and angular velocity of the frame, further on by t_s.
  Eigen::VectorXd twistAt(double t_s) const {
    constexpr int kAllComponents[6] = {0, 1, 2, 3, 4, 5};
    return test::tipJacobian(chain, q + t_s * q_dot, kAllComponents, 6) * q_dot;
  }

  int n;
  std::vector<Joint> joints;
  AttachedFrame frame;
  SerialChain chain;
  JointVector q, q_dot;
};

TEST(VelocityProduct, IsHowTheTwistChangesWhileNoJointAccelerates) {
  test::Random random(41);
  constexpr double kStep_s = 1e-5;
  double largest = 0.0;
  for (int i = 0; i < 400; ++i) {
    const MovingPoint point(random);
    const VelocityProduct product = point.product();
    const Eigen::VectorXd change =
        (point.twistAt(kStep_s) - point.twistAt(-kStep_s)) / (2.0 * kStep_s);
    const double scale = 1.0 + product.linear.norm() + product.angular.norm();
    ASSERT_LT((product.linear - change.head<3>()).norm(), 1e-7 * scale) << "robot " << i;
    ASSERT_LT((product.angular - change.tail<3>()).norm(), 1e-7 * scale) << "robot " << i;
    largest = std::max(largest, product.linear.norm());
  }
  EXPECT_GT(largest, 1.0);
}

TEST(VelocityProduct, GrowsWithTheSquareOfTheSpeed) {
  test::Random random(42);
  for (int i = 0; i < 100; ++i) {
    MovingPoint point(random);
    const VelocityProduct once = point.product();
    point.q_dot *= -3.0;
    EXPECT_LT((point.product().linear - 9.0 * once.linear).norm(),
              1e-11 * (1.0 + once.linear.norm()));
    EXPECT_LT((point.product().angular - 9.0 * once.angular).norm(),
              1e-11 * (1.0 + once.angular.norm()));
  }
}

TEST(VelocityProduct, OfAPointOnACircleIsItsCentripetalAcceleration) {
  std::vector<Joint> joints(2);  // about z, in line
  const SerialChain chain(joints, {1, {}});
  ChainPose pose;
  chain.computePose(JointVector::Zero(2), pose);
  JointVector q_dot(2);
  q_dot << 3.0, 4.0;
  const VelocityProduct product = velocityProduct(chain, pose, 1, Vector3(0.5, 0.0, 0.2), q_dot);
  EXPECT_LT((product.linear - Vector3(-49.0 * 0.5, 0.0, 0.0)).norm(), 1e-14);
  EXPECT_EQ(product.angular, Vector3(Vector3::Zero()));
  const VelocityProduct base = velocityProduct(chain, pose, -1, Vector3::Ones(), q_dot);
  EXPECT_EQ(base.linear, Vector3(Vector3::Zero())) << "the base rests";
}

}  // namespace
}  // namespace tactus
