#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolvervel_pinv_nso.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>

#include "tactus/bench/kdl_chain.h"
#include "tactus/bench/step_case.h"
#include "tactus/math/trajectory.h"

namespace tactus {
namespace {

Pose startPose(const ControllerConfig& config) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  return framePose(pose, config.chain.tip());
}

/// What both solvers need around them: the tool's pose, the reference, and the twist (2).
class KdlRun {
 public:
  explicit KdlRun(const BenchRobot& robot)
      : chain_(kdlChain(robot, robot.config.chain.tip())),
        position_(chain_),
        trajectory_(robot.config.task.trajectory, startPose(robot.config)),
        gain_per_s_(robot.config.gains.task.drift_gain_per_s),
        has_rotation_(robot.config.task.size == 6),
        q_(jointArray(robot.config.q_start)),
        q_dot_(chain_.getNrOfJoints()) {}
  virtual ~KdlRun() = default;

  void step(int i) {
    q_.data[0] += 1e-9;  // as a moving arm: nothing may be reused
    KDL::Frame tool;
    position_.JntToCart(q_, tool);
    const ToolReference reference = trajectory_.evaluate(i * kBenchPeriod_s);
    const KDL::Vector error = toKdl(reference.p_BaseTool) - tool.p;
    KDL::Twist twist(toKdl(reference.v_BaseTool) + gain_per_s_ * error, KDL::Vector::Zero());
    if (has_rotation_) {
      KDL::Rotation R;
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
          R(row, column) = reference.R_BaseTool(row, column);
      twist.rot = toKdl(reference.omega_BaseTool) + gain_per_s_ * KDL::diff(tool.M, R);
    }
    solve(q_, twist, q_dot_);
  }
  JointVector command() const { return q_dot_.data; }

 protected:
  KDL::Chain chain_;

 private:
  virtual void solve(const KDL::JntArray& q, const KDL::Twist& twist, KDL::JntArray& q_dot) = 0;

  KDL::ChainFkSolverPos_recursive position_;
  Trajectory trajectory_;
  double gain_per_s_;
  bool has_rotation_;
  KDL::JntArray q_, q_dot_;
};

class WdlsRun final : public KdlRun {
 public:
  explicit WdlsRun(const BenchRobot& robot) : KdlRun(robot), solver_(chain_) {
    Eigen::MatrixXd weights = Eigen::MatrixXd::Identity(6, 6);
    if (robot.config.task.size == 3) weights.bottomRightCorner(3, 3).setZero();
    solver_.setWeightTS(weights);
    solver_.setLambda(0.05);  // without it, components that do not count are divided by zero
  }

 private:
  void solve(const KDL::JntArray& q, const KDL::Twist& twist, KDL::JntArray& q_dot) override {
    solver_.CartToJnt(q, twist, q_dot);
  }
  KDL::ChainIkSolverVel_wdls solver_;
};

/// Always all six components: this solver has no weights of the task.
class NsoRun final : public KdlRun {
 public:
  explicit NsoRun(const BenchRobot& robot)
      : KdlRun(robot),
        solver_(chain_, jointArray(JointVector::Zero(robot.config.chain.size())),
                jointArray(JointVector::Ones(robot.config.chain.size()))) {}

 private:
  void solve(const KDL::JntArray& q, const KDL::Twist& twist, KDL::JntArray& q_dot) override {
    solver_.CartToJnt(q, twist, q_dot);
  }
  KDL::ChainIkSolverVel_pinv_nso solver_;
};

StepCase makeCase(const char* code, const BenchRobot& robot, std::shared_ptr<KdlRun> run) {
  StepCase step_case;
  step_case.code = code;
  step_case.joints = robot.config.chain.size();
  step_case.task_components = robot.config.task.size;
  step_case.prepare = [] {};
  step_case.step = [run](int i) { run->step(i); };
  step_case.command = [run] { return run->command(); };
  return step_case;
}

}  // namespace

std::vector<StepCase> kdlSolverCases(int joints, int task_components) {
  const BenchRobot robot = makeBenchRobot(joints, task_components, 0);
  std::vector<StepCase> cases = {makeCase(kCodeWdlsOnce, robot, std::make_shared<WdlsRun>(robot))};
  if (task_components == 6)
    cases.push_back(makeCase(kCodeNsoOnce, robot, std::make_shared<NsoRun>(robot)));
  return cases;
}

}  // namespace tactus
