#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "support/controller_run.h"
#include "support/crops9.h"
#include "tactus/control/controller.h"

/// An arm that its limits hold back while it is pushed: the integrals do not grow meanwhile, and
/// the way back after minutes is that after a moment.
namespace tactus {
namespace {

enum class Gate { kVelocity, kAcceleration, kPosition };
constexpr const char* kGateNames[] = {"velocity", "acceleration", "position"};

/// The reference arm, which holds its start pose.
ControllerConfig limitedArm(Variant variant, Gate gate) {
  ControllerConfig config = test::crops9Controller(variant);
  config.task.trajectory.waypoints.clear();
  if (gate == Gate::kVelocity) config.limits.max_velocity.setConstant(5e-4);
  if (gate == Gate::kAcceleration) config.limits.max_acceleration.setConstant(0.02);
  if (gate == Gate::kPosition) {
    config.limits.lower = config.q_start.array() - 0.03;
    config.limits.upper = config.q_start.array() + 0.03;
    config.has_joint_limit_avoidance = false;  // nothing but the gate keeps joints off their limits
  }
  return config;
}

struct ArmAtALimit {
  explicit ArmAtALimit(const ControllerConfig& config)
      : controller(config), state(controller.initialState()) {}

  /// Peak speed of a joint meanwhile.
  double run(double force_N, double duration_s) {
    double fastest = 0.0;
    for (int i = 0; i < std::lround(duration_s / 0.001); ++i) {
      input.q_measured = state.q_desired;
      if (cycle++ % 4 == 0)
        input.tactile[0] = test::touchAt(0.2, force_N, 2.8, input.tactile[0].sequence + 1);
      const ContactControllerState before = state.contact;
      controller.update(input, controller.initialGains(), 1e-3 * static_cast<double>(cycle), 0.001,
                        state, output);
      fastest = std::max(fastest, output.velocity.cwiseAbs().maxCoeff());
      if (before.cut_m_per_s <= 0.0) continue;
      ++cut_cycles;
      EXPECT_LE(state.contact.law.V_m_per_s, before.law.V_m_per_s);
      EXPECT_LE(state.contact.law.It_m_per_s, before.law.It_m_per_s);
    }
    return fastest;
  }

  double error_m() const { return (output.w_d - output.w).norm(); }

  Controller controller;
  ControllerState state;
  ControllerOutput output;
  RobotInput input;
  long cycle = 0;
  int cut_cycles = 0;
};

struct WayBack {
  double time_s = 0.0, peak = 0.0;
};

WayBack wayBack(ArmAtALimit& arm) {
  WayBack back;
  for (int i = 0; i < 100000; ++i) {
    back.peak = std::max(back.peak, arm.run(0.0, 0.001));
    if (arm.error_m() > 1e-3) back.time_s = 1e-3 * i;
  }
  return back;
}

constexpr Variant kLaws[] = {Variant::kNullSpace, Variant::kJointSpace, Variant::kTaskSpace,
                             Variant::kNullTask,  Variant::kNullJoint,  Variant::kNullLimit};

/// Returns in how many cycles of the minutes the gate cut.
int expectSameWayBack(const ControllerConfig& config, double force_N, const char* held_by) {
  ArmAtALimit minutes(config);
  minutes.run(force_N, 60.0);
  const int cut_cycles = minutes.cut_cycles;
  ArmAtALimit moment(config);
  moment.state = moment.controller.initialState(minutes.state.q_desired);
  moment.run(force_N, 0.1);
  const WayBack after_minutes = wayBack(minutes);
  const WayBack after_moment = wayBack(moment);
  std::printf("%d %-12s back %.3f s at %.5f, after a moment %.3f s at %.5f\n",
              static_cast<int>(config.force_control->variant), held_by, after_minutes.time_s,
              after_minutes.peak, after_moment.time_s, after_moment.peak);
  EXPECT_LE(after_minutes.time_s, 1.1 * after_moment.time_s + 0.05);
  EXPECT_LE(after_minutes.peak, 1.02 * after_moment.peak);
  return cut_cycles;
}

TEST(LimitWindup, TheWayBackAfterMinutesIsThatAfterAMoment) {
  for (const Variant variant : kLaws) {
    for (const Gate gate : {Gate::kVelocity, Gate::kPosition}) {
      const char* name = kGateNames[static_cast<int>(gate)];
      SCOPED_TRACE(std::to_string(static_cast<int>(variant)) + name);
      EXPECT_GT(expectSameWayBack(limitedArm(variant, gate), 15.0, name), 1000);
    }
  }
}

/// An arm on its way back to what it touches cannot stop at once; that is no cut of its retreat.
TEST(LimitWindup, NorIsTheWayThatAStopTakesACut) {
  for (const Variant variant : kLaws) {
    SCOPED_TRACE(static_cast<int>(variant));
    ArmAtALimit arm(limitedArm(variant, Gate::kAcceleration));
    arm.run(15.0, 1.0);
    arm.run(0.0, 2.0);
    arm.state.is_stopping = true;
    arm.run(2.0, 0.001);
    arm.cut_cycles = 0;
    ASSERT_GT(arm.run(2.0, 0.01), 1e-4) << "it still moves";
    EXPECT_EQ(arm.cut_cycles, 0);
    EXPECT_EQ(arm.state.contact.cut_m_per_s, 0.0);
  }
}

/// With friction rows keep the joints off their limits, long before the gate would cut.
TEST(LimitWindup, NorIsAnythingRememberedThatRowsOfJointsCut) {
  for (const double force_N : {2.5, 15.0}) {
    SCOPED_TRACE(force_N);
    ControllerConfig config = limitedArm(Variant::kNullLimit, Gate::kPosition);
    config.force_control->friction_coefficient = 0.5;
    expectSameWayBack(config, force_N, "rows");
  }
}

TEST(LimitWindup, NothingGrowsWhileAccelerationIsCut) {
  for (const Variant variant : kLaws) {
    ArmAtALimit arm(limitedArm(variant, Gate::kAcceleration));
    arm.run(15.0, 3.0);
    EXPECT_GT(arm.cut_cycles, 100) << static_cast<int>(variant);
  }
}

}  // namespace
}  // namespace tactus
