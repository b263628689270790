#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "support/random_limits.h"
#include "support/tactile_samples.h"
#include "tactus/control/controller.h"

/// Runs of a controller without a plant: inputs are recorded or random, and outputs are compared to
/// the bit.
namespace tactus::test {

struct RecordedCycle {
  RobotInput input;
  double t_s, period_s;
  ControllerOutput output;
};

inline void expectSameContact(const ContactReport& a, const ContactReport& b) {
  EXPECT_EQ(a.force_contact_N, b.force_contact_N);
  EXPECT_EQ(a.stiffness_N_per_m, b.stiffness_N_per_m);
  EXPECT_EQ(a.stiffness_raw_N_per_m, b.stiffness_raw_N_per_m);
  EXPECT_EQ(a.gamma, b.gamma);
  EXPECT_EQ(a.k_n, b.k_n);
  EXPECT_EQ(a.k_j, b.k_j);
  EXPECT_EQ(a.k_t, b.k_t);
  EXPECT_EQ(a.x_dot_eff_m_per_s, b.x_dot_eff_m_per_s);
  EXPECT_EQ(a.u_n, b.u_n);
  EXPECT_EQ(a.u_j, b.u_j);
  EXPECT_EQ(a.u_t, b.u_t);
}

inline void expectSameMotion(const ControllerOutput& a, const ControllerOutput& b) {
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.q_desired, b.q_desired);
  EXPECT_EQ(a.w, b.w);
  EXPECT_EQ(a.w_d, b.w_d);
  EXPECT_EQ(a.w_d_dot, b.w_d_dot);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.path_time_s, b.path_time_s);
  EXPECT_EQ(a.fault, b.fault);
}

inline void expectSame(const ControllerOutput& a, const ControllerOutput& b) {
  expectSameMotion(a, b);
  expectSameContact(a.contact, b.contact);
  ASSERT_EQ(a.modules, b.modules);
  for (int i = 0; i < a.modules; ++i) {
    EXPECT_EQ(a.sensed[i].force_N, b.sensed[i].force_N);
    EXPECT_EQ(a.sensed[i].position_m, b.sensed[i].position_m);
    EXPECT_EQ(a.sensed[i].direction, b.sensed[i].direction);
  }
}

/// Force that comes and goes at a wandering point, a new sample every few cycles.
class RandomTouches {
 public:
  explicit RandomTouches(Random& random) : random_(random) {}

  RobotInput next(const JointVector& q) {
    if (cycle_++ % 4 == 0) {
      const double swell = std::sin(0.01 * cycle_) + random_.uniform(-0.05, 0.05);
      sample_ = touchAt(0.2 + 0.1 * std::sin(0.003 * cycle_), std::max(0.0, 12.0 * swell),
                        0.5 + 0.001 * cycle_, sample_.sequence + 1);
    }
    return {q, sample_};
  }

 private:
  Random& random_;
  int cycle_ = 0;
  TactileSample sample_;
};

/// A controller with every stage, on a random robot.
inline ControllerConfig fullController(Random& random, int count, Variant variant,
                                       ControlLevel level = ControlLevel::kVelocity) {
  const int task_size = random.integer(1, std::min({count, 6, std::max(1, count - 1)}));
  ControllerConfig config = randomController(random, count, task_size);
  config.weights = randomWeights(random, count);
  config.limits.upper = JointVector::Constant(count, 2.5);
  config.limits.lower = -config.limits.upper;
  config.limits.max_velocity = JointVector::Constant(count, 3.0);
  config.limits.max_acceleration = JointVector::Constant(count, 50.0);
  config.has_joint_limit_avoidance = true;
  config.force_control.emplace();
  config.force_control->variant = variant;
  config.force_control->level = level;
  config.force_control->has_estimator = true;
  if (level == ControlLevel::kVelocity && variant == Variant::kNullLimit && random.chance(0.5))
    config.force_control->friction_coefficient = 0.5;
  Waypoint there;
  there.displacement_m = random.vector<Vector3>(3, -0.2, 0.2);
  there.rotation_vector_rad = random.vector<Vector3>(3, -0.2, 0.2);
  Waypoint back;
  config.task.trajectory = {0.1, {there, back}};
  return config;
}

inline std::vector<RecordedCycle> record(const Controller& controller, Random& random, int cycles) {
  RandomTouches touches(random);
  ControllerState state = controller.initialState();
  std::vector<RecordedCycle> run(cycles);
  double t_s = 0.0;
  for (RecordedCycle& cycle : run) {
    cycle.period_s = 0.001;
    cycle.t_s = t_s;
    cycle.input = touches.next(state.q_desired);
    controller.update(cycle.input, controller.initialGains(), t_s, cycle.period_s, state,
                      cycle.output);
    t_s += cycle.period_s;
  }
  return run;
}

inline constexpr Variant kAllVariants[] = {
    Variant::kNone,     Variant::kNullSpace, Variant::kJointSpace, Variant::kTaskSpace,
    Variant::kNullTask, Variant::kNullJoint, Variant::kNullLimit};

/// Those that there are at the acceleration level.
inline constexpr Variant kAccelerationVariants[] = {Variant::kNullSpace, Variant::kNullTask,
                                                    Variant::kNullLimit};

/// All of both levels.
inline std::vector<std::pair<Variant, ControlLevel>> allLaws() {
  std::vector<std::pair<Variant, ControlLevel>> laws;
  for (const Variant variant : kAllVariants) laws.emplace_back(variant, ControlLevel::kVelocity);
  for (const Variant variant : kAccelerationVariants)
    laws.emplace_back(variant, ControlLevel::kAcceleration);
  return laws;
}

}  // namespace tactus::test
