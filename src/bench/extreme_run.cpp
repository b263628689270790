#include "tactus/bench/extreme_run.h"

#include <algorithm>
#include <cfenv>

#include "tactus/bench/spread.h"
#include "tactus/bench/state_numbers.h"
#include "tactus/record/tool_error.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/stability_check.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

/// Rounding of what the gate computes in another order.
constexpr double kRounding = 1e-12;

/// The key of `file:line:col: key: problem, expected ...`.
std::string keyOf(const InputError& error) {
  const std::string text = error.what();
  const std::size_t key = text.find(": ") + 2;
  return text.substr(key, text.find(": ", key) - key);
}

/// Looks into every cycle.
class CycleWatch {
 public:
  CycleWatch(const JointLimits& limits, double period_s, ExtremeRun& run)
      : limits_(limits), period_s_(period_s), run_(run) {}

  void beforeStep() { std::feclearexcept(FE_UNDERFLOW); }

  void afterStep(const ControllerState& state, const JointVector& velocity_before,
                 const ControllerOutput& output) {
    bool is_subnormal = std::fetestexcept(FE_UNDERFLOW) != 0;
    bool is_finite = output.velocity.allFinite();
    visitNumbers(state, [&](const char*, int, double value) {
      is_finite = is_finite && std::isfinite(value);
      is_subnormal = is_subnormal || std::fpclassify(value) == FP_SUBNORMAL;
    });
    run_.not_finite_cycles += !is_finite;
    run_.subnormal_cycles += is_subnormal;
    run_.beyond_limits_cycles += isBeyond(state.q_desired, velocity_before, output.velocity);
  }

 private:
  bool isBeyond(const JointVector& q, const JointVector& before, const JointVector& v) const {
    const auto exceeds = [](const JointVector& value, const JointVector& limit) {
      return (value.array() > limit.array() * (1.0 + kRounding) + kRounding).any();
    };
    const JointVector change = (v - before).cwiseAbs();
    return exceeds(v.cwiseAbs(), limits_.max_velocity) ||
           exceeds(change, period_s_ * limits_.max_acceleration) ||
           (q.array() > limits_.upper.array()).any() || (q.array() < limits_.lower.array()).any();
  }

  JointLimits limits_;
  double period_s_;
  ExtremeRun& run_;
};

/// Means and extremes of every number of the state, in two tenths of a run.
class StateWatch {
 public:
  StateWatch(long long cycles, ExtremeRun& run) : tenth_(std::max(1LL, cycles / 10)), run_(run) {}

  void add(long long cycle, const ControllerState& state) {
    const long long tenth = cycle / tenth_;
    if (tenth != 1 && tenth != 9) return;
    const bool is_late = tenth == 9;
    std::size_t i = 0;
    visitNumbers(state, [&](const char* name, int index, double value) {
      if (i == run_.state.size())
        run_.state.push_back({std::string(name) + "[" + std::to_string(index) + "]"});
      StateNumber& number = run_.state[i++];
      double& largest = is_late ? number.late_largest : number.early_largest;
      (is_late ? number.late_mean : number.early_mean) += value / static_cast<double>(tenth_);
      largest = std::max(largest, std::abs(value));
    });
  }

 private:
  long long tenth_;
  ExtremeRun& run_;
};

bool isOver(const ControllerOutput& output) {
  return output.fault != Fault::kNone && output.velocity.isZero(0.0);
}

/// Of each component of the force, as it is read.
double noise_N(const SimulatedModuleConfig& module) {
  return module.noise_N * module.channels.calibration.row(0).norm();
}

std::string outcomeOf(const ExtremeRun& run, double noise_N) {
  const bool follows = noise_N > 0.0 && run.restlessness_N <= ExtremeRun::kMostNoise * noise_N;
  if (!run.isBounded()) return "NOT BOUNDED";
  if (run.fault != Fault::kNone) return faultName(run.fault);
  if (!(run.restlessness_N <= ExtremeRun::kMaxRestlessness_N))
    return follows ? "follows noise" : "limit cycle";
  if (!(run.final_speed <= ExtremeRun::kMaxFinalSpeed)) return follows ? "follows noise" : "drifts";
  return "at rest";
}

void play(const Scene& scene, const ExtremeCase& extreme, ExtremeRun& run) {
  const Controller controller(scene.controller);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  const long long cycles = std::llround(scene.duration_s / scene.period_s);
  const long long rest_from = cycles - std::llround(ExtremeRun::kRest_s / scene.period_s);
  CycleWatch watch(scene.controller.limits, scene.period_s, run);
  StateWatch state_watch(cycles, run);
  Spread readings, forces;
  double final_speed = 0.0;
  for (; run.cycles < cycles && !isOver(output); ++run.cycles) {
    const double t_s = static_cast<double>(run.cycles) * scene.period_s;
    robot.read(input);
    if (extreme.reading) extreme.reading(t_s, input.tactile[0]);
    const JointVector velocity_before = state.velocity_before;
    watch.beforeStep();
    controller.update(input, scene.controller.gains, t_s, scene.period_s, state, output);
    watch.afterStep(state, velocity_before, output);
    if (extreme.is_long) state_watch.add(run.cycles, state);
    run.peak_force_N = std::max(run.peak_force_N, robot.trueForce_N());
    run.peak_reading_N = std::max(run.peak_reading_N, output.sensed[0].force_N);
    if (run.cycles >= rest_from) {
      readings.add(output.sensed[0].force_N);
      forces.add(robot.trueForce_N());
      final_speed = std::max(final_speed, output.velocity.cwiseAbs().maxCoeff());
    }
    run.tcp_error_final_m =
        toolError(scene.controller.task, output.w_d, robot.toolPosition()).norm();
    robot.write(output.velocity);
  }
  run.fault = output.fault;
  if (run.fault == Fault::kNone) {
    run.final_reading_N = readings.mean;
    run.restlessness_N = forces.deviation();
    run.final_speed = final_speed;
  }
}

}  // namespace

ExtremeRun runExtreme(const std::string& base, const ExtremeCase& extreme, const ExtremeLaw& law,
                      double duration_share) {
  std::vector<Override> overrides = extreme.overrides;
  overrides.insert(overrides.end(), law.overrides.begin(), law.overrides.end());
  ExtremeRun run;
  try {
    Scene scene = loadScene(base, overrides, SceneUse::kSimulation);
    if (extreme.change) extreme.change(scene);
    scene.duration_s = std::max(scene.duration_s * duration_share, 3.0 * ExtremeRun::kRest_s);
    try {
      checkStability(scene);
    } catch (const InputError& error) {
      run.refused_by_check = keyOf(error);
    }
    play(scene, extreme, run);
    run.outcome = outcomeOf(run, noise_N(scene.plant.modules[0]));
  } catch (const InputError& error) {
    run.refused_at_load = keyOf(error);
    run.outcome = "refused at load";
  }
  return run;
}

}  // namespace tactus
