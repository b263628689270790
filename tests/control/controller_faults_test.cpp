#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "support/controller_run.h"
#include "support/period.h"

/// Every fault ends in rest within the acceleration limits, and rest is where it ends.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class MovingArm {
 public:
  explicit MovingArm(std::uint64_t seed, Variant variant = Variant::kNullTask)
      : random_(seed),
        config_(test::fullController(random_, 8, variant)),
        controller_(config_),
        state_(controller_.initialState()),
        touches_(random_) {
    for (int i = 0; i < 600; ++i) step(touches_.next(state_.q_desired));
  }

  RobotInput touch() { return touches_.next(state_.q_desired); }

  void step(const RobotInput& input) {
    const JointVector before = state_.velocity_before;
    controller_.update(input, controller_.initialGains(), t_s_, kPeriod_s, state_, output_);
    t_s_ += kPeriod_s;
    ASSERT_TRUE(output_.velocity.allFinite());
    const JointVector change = (output_.velocity - before).cwiseAbs();
    ASSERT_LE((change - kPeriod_s * config_.limits.max_acceleration).maxCoeff(), 1e-12);
  }

  /// Good inputs again; the arm must have come to rest in time and stay there.
  void expectRestForGood(Fault fault) {
    const double slowest_s =
        config_.limits.max_velocity.cwiseQuotient(config_.limits.max_acceleration).maxCoeff();
    for (int i = 0; i <= std::ceil(slowest_s / kPeriod_s); ++i) {
      step(touch());
      ASSERT_EQ(output_.fault, fault);
    }
    const JointVector q_rest = state_.q_desired;
    for (int i = 0; i < 500; ++i) {
      step(touch());
      ASSERT_EQ(output_.fault, fault) << "the first fault stays on record";
      ASSERT_EQ(output_.velocity.norm(), 0.0);
    }
    EXPECT_EQ(state_.q_desired, q_rest);
  }

  const ControllerOutput& output() const { return output_; }
  const ControllerConfig& config() const { return config_; }

 private:
  test::Random random_;
  ControllerConfig config_;
  Controller controller_;
  ControllerState state_;
  test::RandomTouches touches_;
  ControllerOutput output_;
  double t_s_ = 0.0;
};

/// A fresh sample with one reading replaced.
RobotInput spoilt(RobotInput input, double TactileSample::*reading, double value) {
  ++input.tactile[0].sequence;
  input.tactile[0].*reading = value;
  return input;
}

TEST(ControllerFaults, MovesWithoutOne) {
  MovingArm arm(191);
  EXPECT_EQ(arm.output().fault, Fault::kNone);
  EXPECT_GT(arm.output().velocity.norm(), 0.05) << "a fault test needs a moving arm";
}

TEST(ControllerFaults, SensorReadingsThatAreNoNumber) {
  for (const auto reading :
       {&TactileSample::force_y_N, &TactileSample::force_z_N, &TactileSample::moment_y_Nm,
        &TactileSample::moment_z_Nm, &TactileSample::moment_x_Nm}) {
    for (const double value : {kNaN, kNoLimit, -kNoLimit}) {
      MovingArm arm(192);
      arm.step(spoilt(arm.touch(), reading, value));
      EXPECT_EQ(arm.output().fault, Fault::kTactileInvalid);
      arm.expectRestForGood(Fault::kTactileInvalid);
    }
  }
}

TEST(ControllerFaults, ForceBeyondTheModulesRange) {
  MovingArm arm(193);
  const double max_force_N = arm.config().tactile_modules.front().max_force_N;
  arm.step(spoilt(arm.touch(), &TactileSample::force_z_N, -1.01 * max_force_N));
  EXPECT_EQ(arm.output().fault, Fault::kTactileInvalid);
  arm.expectRestForGood(Fault::kTactileInvalid);
}

TEST(ControllerFaults, TellTheOffendingForceForGood) {
  MovingArm arm(193);
  const double max_force_N = arm.config().tactile_modules.front().max_force_N;
  RobotInput input = spoilt(arm.touch(), &TactileSample::force_y_N, 3.0 * max_force_N);
  input.tactile[0].force_z_N = -4.0 * max_force_N;
  arm.step(input);
  arm.expectRestForGood(Fault::kTactileInvalid);
  const FaultDetail& detail = arm.output().fault_detail;
  EXPECT_DOUBLE_EQ(detail.value, 5.0 * max_force_N);
  EXPECT_EQ(detail.limit, max_force_N);
  EXPECT_STREQ(detail.unit, "N");
  EXPECT_EQ(detail.joint, -1);
}

TEST(ControllerFaults, AMomentThatIsNoNumberIsNotToldAsAForce) {
  MovingArm arm(193);
  arm.step(spoilt(arm.touch(), &TactileSample::moment_y_Nm, kNaN));
  EXPECT_TRUE(std::isnan(arm.output().fault_detail.value));
  EXPECT_STREQ(arm.output().fault_detail.unit, "N");
}

TEST(ControllerFaults, SampleThatIsTooOld) {
  MovingArm arm(194);
  RobotInput old = arm.touch();
  ++old.tactile[0].sequence;
  arm.step(old);
  for (int i = 1; i <= 20; ++i) {  // max_sample_age_s = 0.02
    arm.step(old);
    if (i < 20) {
      ASSERT_EQ(arm.output().fault, Fault::kNone) << i << " ms";
    }
  }
  arm.step(old);
  EXPECT_EQ(arm.output().fault, Fault::kTactileStale);
  arm.expectRestForGood(Fault::kTactileStale);
  EXPECT_GT(arm.output().fault_detail.value, 0.02);
  EXPECT_LT(arm.output().fault_detail.value, 0.02 + 1.5 * kPeriod_s);
  EXPECT_EQ(arm.output().fault_detail.limit, 0.02);
  EXPECT_STREQ(arm.output().fault_detail.unit, "s");
}

TEST(ControllerFaults, ModuleThatNeverSpeaks) {
  test::Random random(195);
  const ControllerConfig config = test::fullController(random, 5, Variant::kNullSpace);
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int i = 0; i < 30; ++i)
    controller.update({state.q_desired, {}}, controller.initialGains(), i * kPeriod_s, kPeriod_s,
                      state, output);
  EXPECT_EQ(output.fault, Fault::kTactileStale);
}

TEST(ControllerFaults, CommandThatIsNoNumber) {
  for (const auto& [variant, level] : test::allLaws()) {
    test::Random random(196);
    const Controller controller(test::fullController(random, 8, variant, level));
    ControllerState state = controller.initialState();
    test::RandomTouches touches(random);
    ControllerOutput output;
    for (int i = 0; i < 500; ++i)
      controller.update(touches.next(state.q_desired), controller.initialGains(), i * kPeriod_s,
                        kPeriod_s, state, output);
    ASSERT_EQ(output.fault, Fault::kNone);
    state.q_desired[3] = kNaN;  // memory gone bad: no law can give an answer
    for (int i = 0; i < 200; ++i) {
      controller.update(touches.next(state.q_desired), controller.initialGains(), 0.5, kPeriod_s,
                        state, output);
      ASSERT_EQ(output.fault, Fault::kCommandNotFinite);
      ASSERT_TRUE(output.velocity.allFinite());
    }
    EXPECT_EQ(output.velocity.norm(), 0.0);
    EXPECT_FALSE(std::isfinite(output.fault_detail.value));
    EXPECT_EQ(output.fault_detail.joint, 0) << "of all of them the first one";
    EXPECT_GT(output.fault_detail.limit, 0.0);
  }
}

TEST(ControllerFaults, TimeThatIsNoNumberMovesNothing) {
  test::Random random(197);
  const Controller controller(test::fullController(random, 8, Variant::kNullSpace));
  ControllerState state = controller.initialState();
  ControllerOutput output;
  controller.update({state.q_desired, test::touchAt(0.2, 1.0, 0.0, 1)}, controller.initialGains(),
                    kNaN, kPeriod_s, state, output);
  EXPECT_EQ(output.fault, Fault::kCommandNotFinite);
  EXPECT_EQ(output.velocity.norm(), 0.0);
}

TEST(ControllerFaults, NoNumberIsToldWithTheUnitOfItsJoint) {
  for (const JointType type : {JointType::kPrismatic, JointType::kRevolute}) {
    std::vector<Joint> joints(2);
    joints[0].type = type;
    joints[0].axis = Vector3::UnitY();
    joints[1].type = JointType::kPrismatic;
    joints[1].axis = Vector3::UnitX();
    ControllerConfig config{.chain = SerialChain(joints, {1, {}})};
    config.q_start = JointVector::Zero(2);
    config.limits = test::noLimits(2);
    config.limits.max_velocity << 3.0, 5.0;
    config.task.components = {2};
    config.task.size = 1;
    config.weights = JointVector::Ones(2);
    config.has_joint_limit_avoidance = true;
    config.limits.lower = JointVector::Constant(2, -1.0);
    config.limits.upper = JointVector::Constant(2, 1.0);
    const Controller controller(config);
    ControllerState state = controller.initialState();
    state.q_desired[1] = kNaN;
    ControllerOutput output;
    controller.update({state.q_desired, {}}, config.gains, 0.0, kPeriod_s, state, output);
    ASSERT_EQ(output.fault, Fault::kCommandNotFinite);
    const int joint = output.fault_detail.joint;
    ASSERT_GE(joint, 0);
    EXPECT_EQ(output.fault_detail.limit, config.limits.max_velocity[joint]);
    const bool is_prismatic = config.chain.type(joint) == JointType::kPrismatic;
    EXPECT_STREQ(output.fault_detail.unit, is_prismatic ? "m/s" : "rad/s");
  }
}

TEST(ControllerFaults, SeveralModulesAreRefusedByLawsOfOne) {
  for (const Variant variant : test::kAllVariants) {
    test::Random random(198);
    ControllerConfig config = test::fullController(random, 6, variant);
    config.tactile_modules.push_back(config.tactile_modules.front());
    if (variant == Variant::kNullLimit) {
      EXPECT_NO_THROW(Controller{config});
    } else {
      EXPECT_THROW(Controller{config}, std::invalid_argument);
    }
    config.tactile_modules.clear();
    EXPECT_THROW(Controller{config}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace tactus
