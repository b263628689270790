#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "support/allocation_guard.h"
#include "support/closed_loop.h"
#include "support/controller_run.h"
#include "support/random_clearance.h"

/// The cycle touches no heap: controller and simulated robot, in every variant.
namespace tactus {
namespace {

using test::AllocationGuard;

class AllocationGuardDeathTest : public testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

void* volatile escaped;  // keeps the compiler from leaving an allocation out

TEST_F(AllocationGuardDeathTest, EndsTheProgramOnEveryKindOfAllocation) {
  constexpr char kMessage[] = "heap used";
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        escaped = new int;
      },
      kMessage);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        escaped = new double[100];
      },
      kMessage);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        escaped = std::malloc(10);
      },
      kMessage);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        escaped = std::calloc(10, 10);
      },
      kMessage);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        escaped = std::realloc(nullptr, 10);
      },
      kMessage);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        escaped = std::aligned_alloc(64, 64);
      },
      kMessage);
  escaped = std::malloc(10);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        std::free(escaped);
      },
      kMessage);
  EXPECT_DEATH(
      {
        AllocationGuard guard;
        Eigen::VectorXd v(20);
        escaped = v.data();
      },
      kMessage);
}

TEST_F(AllocationGuardDeathTest, LetsTheHeapBeUsedBeforeAndAfter) {
  { AllocationGuard guard; }
  const std::string text(1000, 'x');
  EXPECT_EQ(text.size(), 1000u);
}

class NoAllocation : public testing::TestWithParam<std::pair<Variant, ControlLevel>> {
 protected:
  Variant variant() const { return GetParam().first; }
  ControlLevel level() const { return GetParam().second; }
};

TEST_P(NoAllocation, InTheCycleOfTheReferenceRobotInContact) {
  ControllerConfig config = test::crops9Controller(variant(), true);
  config.force_control->level = level();
  PlantConfig plant = test::crops9Plant(test::scenario2());
  plant.modules[0].quantised = true;
  plant.modules[0].noise_N = 0.02;
  test::ClosedLoop loop(config, plant, 0.001);
  double largest_N = 0.0;
  for (int cycle = 0; cycle < 9000; ++cycle) {
    AllocationGuard guard;
    loop.step();
    largest_N = std::max(largest_N, loop.output().sensed[0].force_N);
  }
  EXPECT_GT(largest_N, 1.25) << "no contact";
}

TEST_P(NoAllocation, InSingularPosesOfAnyRobot) {
  test::Random random(331);
  for (int count : {2, 6, 7, 16}) {
    ControllerConfig config = test::fullController(random, count, variant(), level());
    config.task.components = {0, 1, 2, 3, 4, 5};
    config.task.size = std::min(count, 6);
    config.gains.task.max_return_speed_m_per_s = config.gains.task.max_return_speed_rad_per_s = 0.1;
    config.gains.task.wait_beyond_m = config.gains.task.wait_beyond_rad = 0.01;
    const Controller controller(config);
    for (int pose = 0; pose < 20; ++pose) {
      ControllerState state = controller.initialState();
      state.q_desired = random.vector(count, -0.01, 0.01);
      if (pose % 2 == 0) state.q_desired.setZero();
      ControllerOutput output;
      test::RandomTouches touches(random);
      for (int cycle = 0; cycle < 50; ++cycle) {
        const RobotInput input = touches.next(state.q_desired);
        AllocationGuard guard;
        controller.update(input, controller.initialGains(), cycle * 1e-3, 1e-3, state, output);
      }
    }
  }
}

TEST_P(NoAllocation, WhileAFaultBringsTheArmToRest) {
  test::Random random(332);
  ControllerConfig config = test::fullController(random, 9, variant(), level());
  config.clearance = test::randomBodies(random, 9);
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  test::RandomTouches touches(random);
  for (int cycle = 0; cycle < 600; ++cycle) {
    RobotInput input = touches.next(state.q_desired);
    if (cycle == 400) {
      ++input.tactile[0].sequence;
      input.tactile[0].force_y_N = std::nan("");
    }
    if (cycle == 500) state.q_desired[0] = std::nan("");
    AllocationGuard guard;
    controller.update(input, controller.initialGains(), cycle * 1e-3, 1e-3, state, output);
  }
  EXPECT_EQ(output.fault, Fault::kTactileInvalid);
}

INSTANTIATE_TEST_SUITE_P(Laws, NoAllocation, testing::ValuesIn(test::allLaws()));

TEST(NoAllocationInPose, WhereTheTaskInverseIsDamped) {
  // A stretched planar arm: exactly singular along x.
  std::vector<Joint> joints(4);
  for (Joint& joint : joints) joint.X_ParentJoint.p_AB = Vector3(0.3, 0.0, 0.0);
  ControllerConfig config{.chain = SerialChain(joints, {3, {Matrix3::Identity(), {0.2, 0, 0}}})};
  config.q_start = JointVector::Zero(4);
  config.limits = test::noLimits(4);
  config.weights = JointVector::Ones(4);
  config.task.components = {0, 1};
  config.task.size = 2;
  Waypoint back;
  back.displacement_m = Vector3(-0.1, 0.1, 0.0);
  config.task.trajectory.waypoints = {back};
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int cycle = 0; cycle < 2000; ++cycle) {
    AllocationGuard guard;
    controller.update({state.q_desired, {}}, controller.initialGains(), cycle * 1e-3, 1e-3, state,
                      output);
  }
  EXPECT_LT((output.w_d - output.w).norm(), 0.05);
}

}  // namespace
}  // namespace tactus
