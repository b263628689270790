#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <vector>

#include "tactus/bench/plain_controller.h"

namespace tactus {
namespace {

Eigen::Isometry3d isometry(const Pose& X) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = X.R_AB;
  result.translation() = X.p_AB;
  return result;
}

class SvdKinematics final : public PlainKinematics {
 public:
  explicit SvdKinematics(const BenchRobot& robot) : robot_(robot) {}

  void move(const JointVector& q) override {
    const auto n = static_cast<Eigen::Index>(robot_.joints.size());
    frames_.clear();
    axes_.clear();
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Joint& joint = robot_.joints[i];
      X = X * isometry(joint.X_ParentJoint) * Eigen::AngleAxisd(q[i], joint.axis);
      frames_.push_back(X);
      axes_.push_back(X.linear() * joint.axis);
    }
    tool_ = X * isometry(robot_.config.chain.tip().X_JointFrame);
    Eigen::MatrixXd J(6, n);
    for (Eigen::Index i = 0; i < n; ++i)
      J.col(i) << axes_[i].cross(tool_.translation() - frames_[i].translation()), axes_[i];
    J_ = J.topRows(robot_.config.task.size);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J_, Eigen::ComputeThinU | Eigen::ComputeThinV);
    J_sharp_ = svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal() *
               svd.matrixU().transpose();
    N_ = Eigen::MatrixXd::Identity(n, n) - J_sharp_ * J_;
  }

  Pose tool() const override { return {tool_.linear(), tool_.translation()}; }
  Eigen::VectorXd inverse(const Eigen::VectorXd& w) const override { return J_sharp_ * w; }
  Eigen::VectorXd project(const Eigen::VectorXd& v) const override { return N_ * v; }

  Eigen::VectorXd contactDirection(const ContactPointState& contact,
                                   Vector3& p_BaseContact) const override {
    const AttachedFrame& link = robot_.config.tactile_modules.front().link;
    const Eigen::Isometry3d X = frames_[link.joint] * isometry(link.X_JointFrame);
    p_BaseContact = X * Vector3(contact.position_m, 0.0, 0.0);
    Eigen::MatrixXd J_p = Eigen::MatrixXd::Zero(3, J_.cols());
    for (int i = 0; i <= link.joint; ++i)
      J_p.col(i) = axes_[i].cross(p_BaseContact - frames_[i].translation());
    return J_p.transpose() * (X.linear() * contact.direction);
  }

 private:
  BenchRobot robot_;
  std::vector<Eigen::Isometry3d> frames_;  // of the joints, base frame
  std::vector<Vector3> axes_;              // base frame
  Eigen::Isometry3d tool_;
  Eigen::MatrixXd J_, J_sharp_, N_;
};

}  // namespace

std::unique_ptr<PlainKinematics> svdKinematics(const BenchRobot& robot) {
  return std::make_unique<SvdKinematics>(robot);
}

}  // namespace tactus
