#include "tactus/bench/step_study.h"

#include <gtest/gtest.h>

#include <memory>

#include "tactus/bench/plain_controller.h"
#include "tactus/control/controller.h"
#include "tactus/math/weighted_pseudoinverse.h"
#include "tactus/scene/path_check.h"

namespace tactus {
namespace {

struct Size {
  int joints, task_components, contacts;
};

class BenchStep : public testing::TestWithParam<Size> {};

void expectOurCommands(const BenchRobot& robot, std::unique_ptr<PlainKinematics> kinematics) {
  const Controller ours(robot.config);
  PlainController plain(robot, std::move(kinematics));
  ControllerState our_state = ours.initialState();
  PlainControllerState plain_state = plain.initialState();
  ControllerOutput output;
  double contact_N = 0.0;
  for (int cycle = 0; cycle < 120; ++cycle) {
    const RobotInput input = benchInput(robot, cycle);
    const double t_s = cycle * kBenchPeriod_s;
    ours.update(input, ours.initialGains(), t_s, kBenchPeriod_s, our_state, output);
    const JointVector velocity = plain.update(input, t_s, kBenchPeriod_s, plain_state);
    ASSERT_EQ(output.fault, Fault::kNone);
    ASSERT_LT((velocity - output.velocity).norm(), 1e-9 * (1.0 + output.velocity.norm())) << cycle;
    contact_N += output.contact.force_contact_N;
  }
  EXPECT_EQ(contact_N > 0.0, robot.config.force_control.has_value());
}

TEST_P(BenchStep, OtherCodeCommandsTheSameAsOurs) {
  const auto [joints, task_components, contacts] = GetParam();
  const BenchRobot robot = makeBenchRobot(joints, task_components, contacts);
  expectOurCommands(robot, svdKinematics(robot));
  expectOurCommands(robot, wdlsKinematics(robot));
}

TEST_P(BenchStep, IsFarFromSingular) {
  const auto [joints, task_components, contacts] = GetParam();
  const BenchRobot robot = makeBenchRobot(joints, task_components, contacts);
  EXPECT_GT(
      smallestSingularValueAtStart(robot.config, JointVector::Ones(robot.config.chain.size())),
      2.0 * WeightedPseudoinverse::kDampingThreshold)
      << "damping would be measured as well";
}

INSTANTIATE_TEST_SUITE_P(Sizes, BenchStep,
                         testing::Values(Size{6, 3, 0}, Size{6, 3, 1}, Size{6, 6, 0}, Size{7, 3, 1},
                                         Size{7, 6, 1}, Size{9, 3, 0}, Size{9, 3, 1}, Size{9, 6, 1},
                                         Size{12, 3, 1}, Size{12, 6, 1}, Size{16, 3, 1},
                                         Size{16, 6, 0}, Size{16, 6, 1}));

/// Joint speeds of KDL, through our Jacobian, are the task's.
TEST(KdlSolvers, SolveTheSameTask) {
  for (const int task_components : {3, 6}) {
    const BenchRobot robot = makeBenchRobot(9, task_components, 0);
    const Controller controller(robot.config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    controller.update({}, controller.initialGains(), 0.05, kBenchPeriod_s, state, output);
    ASSERT_GT(output.w_d_dot.norm(), 1e-3) << "at rest anything would agree";
    ASSERT_EQ(kdlSolverCases(9, task_components).size(), task_components == 6 ? 2u : 1u);
    for (const StepCase& step_case : kdlSolverCases(9, task_components)) {
      step_case.step(50);
      EXPECT_EQ(step_case.joints, 9);
      const JointVector q_dot = step_case.command();
      ChainPose pose;
      robot.config.chain.computePose(robot.config.q_start, pose);
      TaskJacobian J;
      computeTipJacobian(robot.config.chain, pose, framePosition(pose, robot.config.chain.tip()),
                         robot.config.task.components.data(), task_components, J);
      const TaskVector w_eff =
          output.w_d_dot + robot.config.gains.task.drift_gain_per_s * output.error;
      EXPECT_LT((J * q_dot - w_eff).norm(), 1e-6) << step_case.code;
    }
  }
}

TEST(StepStudy, HasARowForEachCaseWithTheCountsItIsGiven) {
  StepSizes sizes;
  sizes.joints = {6, 7};
  sizes.batches = 1;
  sizes.cold_steps = 2;
  const Table table = measureSteps(sizes, {{"ours n=7 m=3 contacts=1", 1234.0}});
  // n = 6: 5 + 4 with three components, 6 + 0 with six; n = 7: 4 more.
  EXPECT_EQ(table.rows.size(), 15u + 19u);
  const Filter ours = {{"code", std::string(kCodeOurs)},
                       {"joints", 7.0},
                       {"task_components", 3.0},
                       {"contacts", 1.0}};
  EXPECT_EQ(findNumber(table, "instructions", ours), 1234.0);
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    EXPECT_GT(table.number(row, "warm_ns"), 0.0);
}

TEST(StepStudy, MeasuresTheDeviationFromALine) {
  EXPECT_LT(deviationFromLine({{6.0, 12.0}, {7.0, 14.0}, {16.0, 32.0}}), 1e-12);
  EXPECT_GT(deviationFromLine({{6.0, 36.0}, {9.0, 81.0}, {16.0, 256.0}}), 0.1) << "a square";
}

}  // namespace
}  // namespace tactus
