#include <gtest/gtest.h>

#include "support/expanded_pseudoinverse.h"
#include "support/period.h"
#include "support/random_robot.h"
#include "support/tactile_samples.h"
#include "tactus/control/controller.h"
#include "tactus/math/rotation.h"

/// The signs of (1), (3), (5), (16)-(19) together: what the whole controller commands is put into
/// the contact, and the contact point is moved by differences of its position alone.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kAlpha = 0.7;
constexpr double kPathTime_s = 0.8;

struct Touched {
  Touched(test::Random& random, Variant variant)
      : n(random.integer(3, kMaxJoints)),
        config(test::randomController(random, n, random.integer(1, std::min(n - 1, 4)))) {
    config.weights = test::randomWeights(random, n);
    config.force_control.emplace();
    config.force_control->variant = variant;
    config.gains.force.max_null_speed_m_per_s = 1e9;
    config.gains.force.max_null_speed_rad_per_s = 1e9;
    config.gains.force.pull_gain_per_s = 0.0;  // joint space: (1) alone
    Waypoint line;
    line.displacement_m = random.vector<Vector3>(3, -1.0, 1.0);
    line.rotation_vector_rad = random.vector<Vector3>(3, -0.5, 0.5);
    config.task.trajectory.waypoints = {line};
    x_m = random.uniform(0.05, 0.35);
    angle_rad = random.uniform(-3.0, 3.0);
    force_N = random.uniform(6.0, 20.0);  // above F_th + F_act = 5 N
  }

  void run() {
    const Controller controller(config);
    ControllerState state = controller.initialState();
    state.q_desired = config.q_start + JointVector::Constant(n, 0.002);  // some drift to correct
    controller.update({state.q_desired, test::touchAt(x_m, force_N, angle_rad, 1)},
                      controller.initialGains(), kPathTime_s, kPeriod_s, state, output);
  }

  Vector3 contactPoint(const JointVector& q) const {
    ChainPose pose;
    config.chain.computePose(q, pose);
    const Pose X = framePose(pose, config.tactile_modules.front().link);
    return X.p_AB + X.R_AB * Vector3(x_m, 0.0, 0.0);
  }

  Vector3 forceDirection() const {
    ChainPose pose;
    config.chain.computePose(output.q_desired, pose);
    return framePose(pose, config.tactile_modules.front().link).R_AB *
           Vector3(0.0, std::cos(angle_rad), std::sin(angle_rad));
  }

  /// What the joints change of w; of a part of rx, ry and rz by differences of its error alone.
  TaskJacobian taskJacobian() const {
    const TaskConfig& task = config.task;
    TaskJacobian J =
        test::tipJacobian(config.chain, output.q_desired, task.components.data(), task.size);
    if (!task.hasPartOfRotation()) return J;
    const Matrix3 R_d = Trajectory(task.trajectory, tipPose(config.chain, config.q_start))
                            .evaluate(kPathTime_s)
                            .R_BaseTool;
    constexpr double kStep = 1e-5;
    const auto error = [&](int joint, double step) {
      JointVector q = output.q_desired;
      q[joint] += step;
      return rotationVector(R_d * tipPose(config.chain, q).R_AB.transpose());
    };
    for (int i = 0; i < n; ++i) {
      const Vector3 change = (error(i, -kStep) - error(i, kStep)) / (2.0 * kStep);
      for (int k = 0; k < task.size; ++k)
        if (task.components[k] >= 3) J(k, i) = change[task.components[k] - 3];
    }
    return J;
  }

  /// Velocity of the contact point along F^ for a joint velocity: positive is away.
  double retreat(const JointVector& q_dot) const {
    const double h = 1e-6 / (1e-9 + q_dot.norm());
    const Vector3 step =
        contactPoint(output.q_desired + h * q_dot) - contactPoint(output.q_desired - h * q_dot);
    return forceDirection().dot(step) / (2.0 * h);
  }

  /// a = J_p^T F^, joint by joint from positions.
  Eigen::VectorXd a() const {
    Eigen::VectorXd result(n);
    for (int i = 0; i < n; ++i) result[i] = retreat(JointVector::Unit(n, i));
    return result;
  }

  int n;
  ControllerConfig config;
  double x_m, angle_rad, force_N;
  ControllerOutput output;
};

class ContactSigns : public testing::TestWithParam<Variant> {};

TEST_P(ContactSigns, ForceChangesAsEquation3Says) {
  test::Random random(121);
  for (int i = 0; i < 300; ++i) {
    Touched touched(random, GetParam());
    touched.run();
    const ContactReport& r = touched.output.contact;
    ASSERT_EQ(touched.output.fault, Fault::kNone);
    const double c = r.stiffness_N_per_m;
    const double F_dot = -c * touched.retreat(touched.output.velocity);
    const double expected =
        -c * r.x_dot_eff_m_per_s + c * r.k_t * r.u_t + c * r.k_j * r.u_j + c * r.k_n * r.u_n;
    ASSERT_NEAR(F_dot, expected, 1e-5 * c * (1e-3 + touched.output.velocity.norm())) << i;
    // Every part acts against the force.
    ASSERT_LE(r.u_n, 0.0);
    ASSERT_LE(r.u_j, 0.0);
    ASSERT_LE(r.u_t, 0.0);
    if (GetParam() != Variant::kNone) {
      ASSERT_LT(r.u_n + r.u_j + r.u_t, 0.0);
    }
  }
}

TEST_P(ContactSigns, CommandIsEquation1WithMatrices) {
  test::Random random(122);
  for (int i = 0; i < 300; ++i) {
    Touched touched(random, GetParam());
    // Limits so wide that only the cost of them is felt.
    touched.config.limits.upper = JointVector::Constant(touched.n, 20.0);
    touched.config.limits.lower = JointVector::Constant(touched.n, -25.0);
    touched.config.has_joint_limit_avoidance = true;
    touched.config.gains.joint_limit_avoidance.gain = kAlpha;
    touched.config.gains.joint_limit_avoidance.active_fraction = 1.0;
    touched.run();
    const ControllerConfig& config = touched.config;
    const ControllerOutput& output = touched.output;
    const auto inverse = test::expandPseudoinverse(touched.taskJacobian(), config.weights);
    const Eigen::VectorXd b = touched.a().cwiseQuotient(config.weights);
    // Joint-limit avoidance follows W^-1 dH/dq, like every controller its b.
    const Eigen::VectorXd gradient =
        3.52 * (output.q_desired.array() + 2.5).matrix().cwiseQuotient(config.weights) /
        22.5;  // linear from the middle, -2.5
    const Eigen::VectorXd w_eff = output.w_d_dot + 5.0 * output.error;
    const Eigen::MatrixXd I_minus_N = Eigen::MatrixXd::Identity(touched.n, touched.n) - inverse.N;
    const ContactReport& r = output.contact;
    // J# J = I - N holds in every pose; J# J with a damped J# would not.
    const Eigen::VectorXd q_dot = inverse.J_sharp * w_eff - I_minus_N * b * r.u_t - b * r.u_j -
                                  inverse.N * (b * r.u_n + kAlpha * gradient);
    ASSERT_LT((output.velocity - q_dot).norm(), 1e-5 * (1e-2 + q_dot.norm() + b.norm())) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, ContactSigns,
                         testing::Values(Variant::kNone, Variant::kNullSpace, Variant::kJointSpace,
                                         Variant::kTaskSpace, Variant::kNullTask,
                                         Variant::kNullJoint, Variant::kNullLimit));

TEST(ContactSigns, JointSpaceIsEquation6) {
  test::Random random(123);
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    Touched touched(random, Variant::kJointSpace);
    touched.config.weights.setOnes();
    touched.run();
    const ControllerConfig& config = touched.config;
    const ControllerOutput& output = touched.output;
    const ContactReport& r = output.contact;
    if (r.x_dot_eff_m_per_s > 0.0 || r.k_j < 0.01) continue;  // no feedforward against a retreat
    const TaskJacobian J = touched.taskJacobian();
    const Eigen::VectorXd w_eff = output.w_d_dot + 5.0 * output.error;
    const Eigen::VectorXd a = touched.a();
    const Eigen::MatrixXd S_w =
        Eigen::MatrixXd::Identity(touched.n, touched.n) - a * a.transpose() / a.squaredNorm();
    const double F_c = 2.0 * 0.5 / (0.1 * 7000.0 * a.squaredNorm()) * (touched.force_N - 1.2);
    const Eigen::VectorXd q_dot =
        S_w * test::expandPseudoinverse(J, config.weights).J_sharp * w_eff + a * F_c;
    ASSERT_LT((output.velocity - q_dot).norm(), 1e-6 * (1e-2 + q_dot.norm() + a.norm())) << i;
    ++compared;
  }
  EXPECT_GT(compared, 80);
}

}  // namespace
}  // namespace tactus
