#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"
#include "tactus/supervisor/apply_mode.h"
#include "tactus/supervisor/mode.h"

/// An arm that meets an obstacle, and a fault in the contact: controller, modes and the simulated
/// robot, without buses.
namespace tactus::test {

/// What befalls the module's samples; kNone: nothing but what they say.
enum class SampleTrouble { kNone, kSilent, kNotANumber, kSaturated, kCableBreak, kStuckExcess };

class RetreatArm {
 public:
  struct Cycle {
    RobotInput input;
    Mode mode;
    Fault fault;
    double task_time_s;
    ControllerOutput output;
  };

  RetreatArm(const Scene& scene, std::uint64_t seed)
      : controller_(scene.controller),
        robot_(scene.controller, scene.plant, scene.period_s),
        random_(seed),
        state_(controller_.initialState()),
        period_s_(scene.period_s) {
    mode_.mode = Mode::kRunning;
  }

  void step() {
    const std::array<TactileSample, kMaxTactileModules> before = input_.tactile;
    robot_.read(input_);
    if (noise_N > 0.0) addNoise(before[0]);
    const Fault told = spoil(before);
    ModeInput mode;
    mode.fault = extra_fault != Fault::kNone ? extra_fault
                 : told != Fault::kNone      ? told
                                             : output_.fault;
    mode.has_enable_line = true;
    mode.enable = enable;
    mode.are_enabled = true;
    mode.are_disabled = false;
    mode.is_at_rest = output_.velocity.isZero(0.0);
    mode.is_retreat_over = state_.retreat.is_over;
    const Mode mode_before = mode_.mode;
    updateMode({}, mode, mode_);
    applyMode(controller_, mode_.mode, mode_before, input_, controller_.initialGains(), state_);
    const double task_time_s = static_cast<double>(task_cycle_) * period_s_;
    controller_.update(input_, controller_.initialGains(), task_time_s, period_s_, state_, output_);
    robot_.write(isCommanding(mode_.mode)
                     ? output_.velocity
                     : JointVector(JointVector::Zero(output_.velocity.size())));
    if (is_recorded) cycles.push_back({input_, mode_.mode, mode_.fault, task_time_s, output_});
    task_cycle_ += mode_.mode == Mode::kRunning ? 1 : 0;
    ++cycle_;
  }
  void run(double duration_s) {
    for (int i = 0; i < std::lround(duration_s / period_s_); ++i) step();
  }
  /// False: it did not come to that.
  template <typename Condition>
  bool runUntil(double longest_s, const Condition& condition) {
    for (int i = 0; i < std::lround(longest_s / period_s_); ++i) {
      if (condition()) return true;
      step();
    }
    return condition();
  }

  double force_N() const { return robot_.trueForce_N(); }
  Mode mode() const { return mode_.mode; }
  Fault fault() const { return mode_.fault; }
  const ControllerOutput& output() const { return output_; }
  const ControllerState& state() const { return state_; }
  const Controller& controller() const { return controller_; }

  SampleTrouble trouble = SampleTrouble::kNone;
  Fault extra_fault = Fault::kNone;  ///< seen beside
  bool enable = true;
  bool is_recorded = false;
  double noise_N = 0.0;
  std::vector<Cycle> cycles;

 private:
  /// Once a sample.
  void addNoise(const TactileSample& before) {
    TactileSample& sample = input_.tactile[0];
    if (sample.sequence == before.sequence) {
      sample = before;
      return;
    }
    constexpr double kLever_m = 0.2;
    for (double* force : {&sample.force_y_N, &sample.force_z_N}) *force += normal();
    for (double* moment : {&sample.moment_y_Nm, &sample.moment_z_Nm})
      *moment += kLever_m * normal();
  }
  double normal() {
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) sum += random_.uniform(-0.5, 0.5);
    return noise_N * sum;
  }

  /// As receivers hand it on: of a sample that the module calls none they say so alone.
  Fault spoil(const std::array<TactileSample, kMaxTactileModules>& before) {
    TactileSample& sample = input_.tactile[0];
    switch (trouble) {
      case SampleTrouble::kNone:
        return Fault::kNone;
      case SampleTrouble::kNotANumber:
        sample.force_y_N = std::numeric_limits<double>::quiet_NaN();
        return Fault::kNone;
      case SampleTrouble::kStuckExcess:
        sample.force_y_N = 150.0;
        sample.force_z_N = 20.0;
        return Fault::kNone;
      case SampleTrouble::kSilent:
        sample = before[0];
        return Fault::kNone;
      case SampleTrouble::kSaturated:
        sample = before[0];
        return Fault::kTactileSaturated;
      case SampleTrouble::kCableBreak:
        sample = before[0];
        return Fault::kTactileCableBreak;
    }
    return Fault::kNone;
  }

  Controller controller_;
  SimulatedRobot robot_;
  Random random_;
  ModeState mode_;
  ControllerState state_;
  RobotInput input_;
  ControllerOutput output_;
  double period_s_;
  long cycle_ = 0, task_cycle_ = 0;
};

/// An arm in any posture, whose task drives the link with the module against a post or a band.
inline Scene touchingScene(Random& random, const std::string& name,
                           const std::vector<Override>& overrides) {
  Scene scene = shippedScene(name, overrides);
  ControllerConfig& config = scene.controller;
  const int n = config.chain.size();
  for (int i = 0; i < n; ++i) {
    const double low = std::max(config.limits.lower[i], -2.0);
    const double high = std::min(config.limits.upper[i], 2.0);
    config.q_start[i] = 0.5 * (low + high) + 0.35 * (high - low) * random.uniform(-1.0, 1.0);
  }
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  const TactileModuleConfig& module = config.tactile_modules.front();
  const Pose X = framePose(pose, module.link);
  const Vector3 axis = X.R_AB.col(0);
  const Vector3 point = X.p_AB + random.uniform(0.3, 0.9) * module.length_m * axis;
  const Vector3 along(axis.x(), axis.y(), 0.0);
  Vector3 aside = Vector3::UnitZ().cross(along).normalized() * random.sign();
  const double radius_m = scene.plant.modules.front().cover_radius_m;
  const double gap_m = random.uniform(0.002, 0.02);
  const double lateral_m = radius_m + gap_m;
  const Vector3 post = point + lateral_m * aside;
  const double stiffness = random.logUniform(300.0, 2e5);
  scene.plant.obstacles = {
      {.x_m = post.x(), .y_m = post.y(), .stiffness_N_per_m = stiffness, .foam = {}}};
  Waypoint line;
  line.displacement_m = 0.4 * aside;
  line.speed_m_per_s = random.logUniform(0.03, 0.2);
  line.ramp_s = 0.2;
  config.task.trajectory = {0.05, {line}};
  return scene;
}

}  // namespace tactus::test
