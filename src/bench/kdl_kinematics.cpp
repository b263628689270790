#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tactus/bench/kdl_chain.h"
#include "tactus/bench/plain_controller.h"

namespace tactus {
namespace {

Vector3 fromKdl(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

Pose fromKdl(const KDL::Frame& X) {
  Pose pose;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) pose.R_AB(row, column) = X.M(row, column);
  pose.p_AB = fromKdl(X.p);
  return pose;
}

AttachedFrame linkOf(const BenchRobot& robot) {
  const std::vector<TactileModuleConfig>& modules = robot.config.tactile_modules;
  return modules.empty() ? robot.config.chain.tip() : modules.front().link;
}

/// Damps only singular values below the solver's 1e-5; without it, those of components that do not
/// count would be divided by zero.
constexpr double kDamping = 0.05;

class WdlsKinematics final : public PlainKinematics {
 public:
  explicit WdlsKinematics(const BenchRobot& robot)
      : task_size_(robot.config.task.size),
        link_joints_(linkOf(robot).joint + 1),
        chain_(kdlChain(robot, robot.config.chain.tip())),
        link_chain_(kdlChain(robot, linkOf(robot))),
        position_(chain_),
        link_position_(link_chain_),
        jacobian_solver_(chain_),
        link_jacobian_solver_(link_chain_),
        inverse_solver_(chain_),
        q_(chain_.getNrOfJoints()),
        q_dot_(chain_.getNrOfJoints()),
        J_(chain_.getNrOfJoints()) {
    Eigen::MatrixXd weights = Eigen::MatrixXd::Identity(6, 6);
    if (task_size_ == 3) weights.bottomRightCorner(3, 3).setZero();
    inverse_solver_.setWeightTS(weights);
    inverse_solver_.setLambda(kDamping);
  }

  void move(const JointVector& q) override {
    q_.data = q;
    position_.JntToCart(q_, tool_);
    jacobian_solver_.JntToJac(q_, J_);
  }

  Pose tool() const override { return fromKdl(tool_); }

  Eigen::VectorXd inverse(const Eigen::VectorXd& w) const override {
    KDL::Twist twist = KDL::Twist::Zero();
    for (int i = 0; i < task_size_; ++i) twist[i] = w[i];
    inverse_solver_.CartToJnt(q_, twist, q_dot_);
    return q_dot_.data;
  }

  Eigen::VectorXd project(const Eigen::VectorXd& v) const override {
    return v - inverse(J_.data.topRows(task_size_) * v);
  }

  Eigen::VectorXd contactDirection(const ContactPointState& contact,
                                   Vector3& p_BaseContact) const override {
    KDL::JntArray q(static_cast<unsigned>(link_joints_));
    q.data = q_.data.head(link_joints_);
    KDL::Frame X;
    link_position_.JntToCart(q, X);
    KDL::Jacobian J_p(static_cast<unsigned>(link_joints_));
    link_jacobian_solver_.JntToJac(q, J_p);
    const KDL::Vector offset = X.M * KDL::Vector(contact.position_m, 0.0, 0.0);
    J_p.changeRefPoint(offset);
    p_BaseContact = fromKdl(X.p + offset);
    Eigen::VectorXd a = Eigen::VectorXd::Zero(q_.data.size());
    a.head(link_joints_) =
        J_p.data.topRows(3).transpose() * fromKdl(X.M * toKdl(contact.direction));
    return a;
  }

 private:
  int task_size_, link_joints_;
  KDL::Chain chain_, link_chain_;
  KDL::ChainFkSolverPos_recursive position_;
  // KDL's solvers are not const where they compute.
  mutable KDL::ChainFkSolverPos_recursive link_position_;
  KDL::ChainJntToJacSolver jacobian_solver_;
  mutable KDL::ChainJntToJacSolver link_jacobian_solver_;
  mutable KDL::ChainIkSolverVel_wdls inverse_solver_;
  KDL::JntArray q_;
  mutable KDL::JntArray q_dot_;
  KDL::Jacobian J_;
  KDL::Frame tool_;
};

}  // namespace

KDL::Chain kdlChain(const BenchRobot& robot, const AttachedFrame& end) {
  KDL::Chain chain;
  const std::vector<Joint>& joints = robot.joints;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None),
                                KDL::Frame(toKdl(joints.front().X_ParentJoint.p_AB))));
  for (int i = 0; i <= end.joint; ++i) {
    const Vector3 p_next = i < end.joint ? joints[i + 1].X_ParentJoint.p_AB : end.X_JointFrame.p_AB;
    const KDL::Joint joint(KDL::Vector::Zero(), toKdl(joints[i].axis), KDL::Joint::RotAxis);
    chain.addSegment(KDL::Segment(joint, KDL::Frame(toKdl(p_next))));
  }
  return chain;
}

std::unique_ptr<PlainKinematics> wdlsKinematics(const BenchRobot& robot) {
  return std::make_unique<WdlsKinematics>(robot);
}

}  // namespace tactus
