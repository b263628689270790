#include <gtest/gtest.h>

#include <array>

#include "support/controller_run.h"
#include "support/period.h"
#include "tactus/control/module_loss.h"

/// What a controller makes of modules that fall silent or tell of an excess, case by case.
namespace tactus {
namespace {

using test::kPeriod_s;

constexpr int kSkin = 3;
constexpr double kSlowShare = 0.3;

ControllerConfig lawlessSkin(test::Random& random) {
  ControllerConfig config = test::fullController(random, 7, Variant::kNone);
  config.force_control.reset();
  while (config.tactile_modules.size() < kSkin)
    config.tactile_modules.push_back(config.tactile_modules.front());
  config.module_loss = ModuleLossConfig{kSlowShare};
  return config;
}

/// An arm with three modules.
struct SkinArm {
  explicit SkinArm(std::uint64_t seed) : random(seed) {}
  void step(std::array<bool, kSkin> speaks, double force_N = 0.0) {
    RobotInput input{state.q_desired, {}};
    for (int i = 0; i < kSkin; ++i)
      input.tactile[i] = test::touchAt(0.2, speaks[i] ? force_N : 0.0, 0.0,
                                       state.modules[i].sequence + (speaks[i] ? 1 : 0));
    controller.update(input, config.gains, 0.0, kPeriod_s, state, output);
  }

  test::Random random;
  ControllerConfig config = lawlessSkin(random);
  Controller controller{config};
  ControllerState state = controller.initialState();
  ControllerOutput output;
};

/// Not by an arm that has a fault or stops, nor without the rule.
TEST(ModuleLoss, IsBorneByAnArmThatMoves) {
  const SkinArm arm(78);
  const auto goesOn = [&](const ControllerState& state) {
    return arm.controller.goesOnWithout(1, arm.config.gains, state);
  };
  ControllerState state = arm.state;
  EXPECT_TRUE(goesOn(state));
  state.is_stopping = true;
  EXPECT_FALSE(goesOn(state));
  state.fault = Fault::kCommandNotFinite;
  EXPECT_FALSE(goesOn(state));
  state.is_stopping = false;
  EXPECT_FALSE(goesOn(state));
  state.modules[1].is_lost = true;
  EXPECT_TRUE(goesOn(state)) << "it was lost before";
  ControllerConfig strict = arm.config;
  strict.module_loss.reset();
  EXPECT_FALSE(Controller(strict).goesOnWithout(1, strict.gains, arm.state));
}

/// In 0.2 s from all to nothing, as far as the share; and back once the module was good for 1 s.
TEST(ModuleLoss, SlowsTheArmUntilTheModuleHasProvenItself) {
  SkinArm arm(83);
  const auto run = [&](bool speaks, int cycles) {
    for (int i = 0; i < cycles; ++i) arm.step({speaks, true, true});
    return arm.output.speed_share;
  };
  EXPECT_EQ(run(true, 50), 1.0);
  int silent = 0;
  while (arm.output.modules_lost == 0 && silent++ < 50) run(false, 1);
  EXPECT_NEAR(run(false, 100), 0.5, 0.011);
  EXPECT_EQ(run(false, 100), kSlowShare);
  EXPECT_EQ(run(true, 998), kSlowShare);
  EXPECT_NEAR(run(true, 100), kSlowShare + 0.5, 0.021);
  EXPECT_EQ(run(true, 100), 1.0);
  EXPECT_EQ(arm.output.modules_lost, 0u);
}

/// Nobody knows the way on which the force came that it tells of first.
TEST(ModuleLoss, TeachesNoStiffnessWhenTheModuleComesBackUnderLoad) {
  for (std::uint64_t seed = 90; seed < 110; ++seed) {
    test::Random random(seed);
    ControllerConfig config = test::fullController(random, 7, Variant::kNullLimit);
    while (config.tactile_modules.size() < kSkin)
      config.tactile_modules.push_back(config.tactile_modules.front());
    config.module_loss = ModuleLossConfig{kSlowShare};
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    double t_s = 0.1;
    const auto run = [&](int cycles, bool speaks, double force_N) {
      for (int i = 0; i < cycles; ++i, t_s += kPeriod_s) {
        RobotInput input{state.q_desired, {}};
        for (int k = 0; k < kSkin; ++k)
          input.tactile[k] = test::touchAt(0.2, k == 0 ? force_N : 0.0, 0.0,
                                           state.modules[k].sequence + (k > 0 || speaks ? 1 : 0));
        controller.update(input, config.gains, t_s, kPeriod_s, state, output);
      }
    };
    run(100, true, 0.0);
    run(300, false, 0.0);
    ASSERT_EQ(output.modules_lost, 1u) << seed;
    const double assumed_N_per_m = config.gains.force.assumed_stiffness_N_per_m;
    const ApproachEstimatorState& estimator = state.several.modules[0].approach.estimator;
    EXPECT_NEAR(estimator.stiffness_N_per_m, assumed_N_per_m, 1e-6 * assumed_N_per_m);
    run(1, true, 8.0);
    ASSERT_EQ(output.fault, Fault::kNone) << seed;
    EXPECT_NEAR(estimator.stiffness_N_per_m, assumed_N_per_m, 1e-6 * assumed_N_per_m) << seed;
    EXPECT_EQ(estimator.F_ref_N, estimator.F_before_N);
    EXPECT_GT(estimator.F_ref_N, 0.0);
  }
}

/// What stops the arm is the module that was good until then, else the first of those that tell of
/// a push.
TEST(ModuleLoss, IsNotBlamedForTheFaultOfAnother) {
  SkinArm arm(79);
  for (int i = 0; i < 100; ++i) arm.step({false, true, true});
  ASSERT_EQ(arm.output.modules_lost, 1u);
  for (int i = 0; i < 100 && arm.output.fault == Fault::kNone; ++i) arm.step({false, false, false});
  EXPECT_EQ(arm.output.fault, Fault::kTactileStale);
  EXPECT_EQ(arm.output.fault_detail.module, 1);

  SkinArm pushed(79);
  for (int i = 0; i < 100; ++i) pushed.step({false, false, true});
  ASSERT_EQ(pushed.output.modules_lost, 3u);
  const double excess_N = 2.0 * pushed.config.tactile_modules.front().max_force_N;
  pushed.step({true, true, false}, excess_N);
  EXPECT_EQ(pushed.output.fault, Fault::kTactileInvalid);
  EXPECT_EQ(pushed.output.fault_detail.module, 0);
}

/// The way back begins with the motion at the fault; a stop that was under way has its own.
TEST(ModuleFault, RemembersTheMotionThatItEnds) {
  for (const bool is_stopping : {false, true}) {
    SkinArm arm(80);
    arm.step({true, true, true});
    arm.state.is_stopping = is_stopping;
    arm.state.velocity_before.setConstant(0.02);
    arm.state.retreat.velocity_at_fault.setConstant(7, 0.5);
    arm.step({true, true, true}, 2.0 * arm.config.tactile_modules.front().max_force_N);
    ASSERT_EQ(arm.output.fault, Fault::kTactileInvalid);
    EXPECT_EQ(arm.state.retreat.velocity_at_fault,
              JointVector(JointVector::Constant(7, is_stopping ? 0.5 : 0.02)));
  }
}

/// All of the motion without contact, at both levels: out of the joints' zones, too.
TEST(ModuleLoss, SlowsAllThatIsNoAnswer) {
  for (const ControlLevel level : {ControlLevel::kVelocity, ControlLevel::kAcceleration}) {
    test::Random random(81);
    ControllerConfig config = test::fullController(random, 7, Variant::kNullLimit, level);
    config.force_control->friction_coefficient = 0.0;
    config.limits.max_velocity.setConstant(1e3);
    config.limits.max_acceleration.setConstant(1e9);
    config.limits.upper = config.q_start.array() + 0.2;
    config.limits.lower = config.q_start.array() - 2.0;
    config.gains.force.velocity_gain_per_s = 1e9;  // at once
    config.module_loss = ModuleLossConfig{kSlowShare};
    const Controller controller(config);
    const auto velocity = [&](double share) {
      ControllerState state = controller.initialState();
      state.speed_share = share;
      ControllerOutput output;
      controller.update({state.q_desired, test::touchAt(0.2, 0.0, 0.0, 1)}, config.gains, 0.3,
                        kPeriod_s, state, output);
      EXPECT_EQ(output.speed_share, share);
      return output.velocity;
    };
    const JointVector whole = velocity(1.0);
    EXPECT_GT(whole.norm(), 0.1);
    EXPECT_LT((velocity(kSlowShare) - kSlowShare * whole).norm(), 1e-6 * whole.norm());
  }
}

/// A cycle in which nothing else is done: samples are taken over, or age.
TEST(WatchedSensors, AreKnownToTheNextCycle) {
  SkinArm arm(82);
  RobotInput input{arm.state.q_desired, {}};
  input.tactile[1] = test::touchAt(0.2, 5.0, 0.0, 9);
  for (int i = 0; i < 3; ++i) arm.controller.watchSensors(input, kPeriod_s, arm.state);
  EXPECT_EQ(arm.state.modules[1].sequence, 9u);
  EXPECT_NEAR(arm.state.modules[1].contact.force_N, 5.0, 1e-12);
  EXPECT_NEAR(arm.state.modules[1].age_s, 2 * kPeriod_s, 1e-15);
  for (const int silent : {0, 2})
    EXPECT_NEAR(arm.state.modules[silent].age_s, 3 * kPeriod_s, 1e-15);
  const FaultDetail age = arm.controller.sampleAge(1, input, kPeriod_s, arm.state);
  EXPECT_NEAR(age.value, 3 * kPeriod_s, 1e-15);
  EXPECT_EQ(age.limit, arm.config.tactile_modules[1].max_sample_age_s);
  EXPECT_STREQ(age.unit, "s");
  EXPECT_EQ(age.joint, -1);
  EXPECT_EQ(age.module, 1);
}

}  // namespace
}  // namespace tactus
