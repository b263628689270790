#include <gtest/gtest.h>

#include "support/controller_run.h"

/// The output is a pure function of config, state, input, time and period.
namespace tactus {
namespace {

void expectSameAgain(const ControllerConfig& config, test::Random& random) {
  const std::vector<test::RecordedCycle> run = test::record(Controller(config), random, 1500);
  const Controller replayed(config);
  ControllerState state = replayed.initialState();
  ControllerOutput output;
  for (const test::RecordedCycle& cycle : run) {
    replayed.update(cycle.input, replayed.initialGains(), cycle.t_s, cycle.period_s, state, output);
    test::expectSame(output, cycle.output);
    ASSERT_FALSE(testing::Test::HasFailure()) << "at " << cycle.t_s;
  }
}

TEST(ControllerReplay, RecordedInputsGiveEveryOutputAgainToTheBit) {
  test::Random random(181);
  for (const auto& [variant, level] : test::allLaws())
    expectSameAgain(test::fullController(random, 7, variant, level), random);
}

TEST(ControllerReplay, ACopyOfTheStateGoesOnLikeTheOriginal) {
  test::Random random(182);
  const Controller controller(test::fullController(random, 9, Variant::kNullTask));
  ControllerState state = controller.initialState();
  test::RandomTouches touches(random);
  for (int cycle = 0; cycle < 1000; ++cycle) {
    ControllerState copy = state;
    const RobotInput input = touches.next(state.q_desired);
    ControllerOutput original;
    ControllerOutput copied;
    copied.contact.u_n = 1e9;  // what an output held before must not matter
    controller.update(input, controller.initialGains(), cycle * 1e-3, 1e-3, state, original);
    controller.update(input, controller.initialGains(), cycle * 1e-3, 1e-3, copy, copied);
    test::expectSame(original, copied);
    ASSERT_FALSE(HasFailure()) << "cycle " << cycle;
  }
}

TEST(ControllerReplay, ControllersDoNotTouchEachOther) {
  test::Random random(183);
  const Controller a(test::fullController(random, 6, Variant::kJointSpace));
  const Controller b(test::fullController(random, 9, Variant::kNullJoint));
  const std::vector<test::RecordedCycle> alone = test::record(a, random, 500);
  ControllerState state_a = a.initialState();
  ControllerState state_b = b.initialState();
  ControllerOutput output_a;
  ControllerOutput output_b;
  for (const test::RecordedCycle& cycle : alone) {
    a.update(cycle.input, a.initialGains(), cycle.t_s, cycle.period_s, state_a, output_a);
    b.update(cycle.input, b.initialGains(), cycle.t_s, cycle.period_s, state_b, output_b);
    test::expectSame(output_a, cycle.output);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(ControllerReplay, AnotherConfigurationGivesAnotherOutput) {
  test::Random random(184);
  ControllerConfig config = test::fullController(random, 7, Variant::kNullSpace);
  const std::vector<test::RecordedCycle> run = test::record(Controller(config), random, 1000);
  config.gains.force.time_constant_s *= 2.0;
  const Controller other(config);
  ControllerState state = other.initialState();
  ControllerOutput output;
  int different = 0;
  for (const test::RecordedCycle& cycle : run) {
    other.update(cycle.input, other.initialGains(), cycle.t_s, cycle.period_s, state, output);
    different += output.velocity != cycle.output.velocity;
  }
  EXPECT_GT(different, 500);
}

}  // namespace
}  // namespace tactus
