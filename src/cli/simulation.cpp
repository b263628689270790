#include "tactus/cli/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tactus/control/controller.h"
#include "tactus/record/tool_error.h"
#include "tactus/record/ulog_writer.h"
#include "tactus/sim/simulated_robot.h"
#include "tactus/supervisor/apply_mode.h"
#include "tactus/supervisor/cycle_record.h"

namespace tactus {
namespace {

using Clock = std::chrono::steady_clock;

/// After a fault, until sensors tell what is left of the force.
constexpr double kRest_s = 0.3;
constexpr long long kCyclesBetweenReports = 8192;
/// Longer runs pay for their memory as they go.
constexpr long long kMaxReservedCycles = 1'000'000;

std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

/// The first fault of a run; a later one is not asked for.
void noteFault(const ControllerOutput& output, double t_s, FaultReport& end) {
  if (output.fault == Fault::kNone || end.fault != Fault::kNone) return;
  end.fault = output.fault;
  end.time_s = t_s;
  end.joint = output.fault_detail.joint;
  end.detail = output.fault_detail;
}

/// As the daemon's receivers find it in the counts of the newest samples.
void judgeChannels(const SimulatedRobot& robot, double t_s, FaultReport& end) {
  for (int i = 0; i < robot.modules() && end.fault == Fault::kNone; ++i) {
    if (!robot.module(i).isSaturated()) continue;
    end.fault = Fault::kTactileSaturated;
    end.time_s = t_s;
    end.detail.module = i;
  }
}

/// As the daemon's after the next cycle; but a command that is no number the controller answers
/// itself.
Mode modeAfter(Mode before, Fault fault, const RetreatState& retreat) {
  if (faultRow(fault).reaction != Reaction::kRetreat) return Mode::kRunning;
  const bool is_left = before == Mode::kRetreating && retreat.is_over;
  return is_left || before == Mode::kHolding ? Mode::kHolding : Mode::kRetreating;
}

bool isAtRest(Mode mode, const FaultReport& end, const ControllerOutput& output) {
  return end.fault != Fault::kNone && mode != Mode::kRetreating && output.velocity.isZero(0.0);
}

/// The newest that the module does not call none, as the daemon's receivers take them.
void read(SimulatedRobot& robot, RobotInput& input) {
  const auto before = input.tactile;
  robot.read(input);
  for (int i = 0; i < robot.modules(); ++i)
    if (robot.module(i).isSaturated()) input.tactile[i] = before[i];
}

}  // namespace

SimulationResult simulate(const Scene& scene, const CycleSink& sink) {
  const auto cycles = std::llround(scene.duration_s / scene.period_s);
  const Controller controller(scene.controller);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  RunSummary summary(scene.controller,
                     static_cast<std::size_t>(std::min(cycles, kMaxReservedCycles)));
  ControllerState state = controller.initialState();
  ToolRotationError rotation_error(scene.controller);
  RobotInput input;
  ControllerOutput output;
  CycleRecord record;
  FaultReport end;
  Mode mode = Mode::kRunning;
  const auto cycles_at_rest = std::llround(kRest_s / scene.period_s);
  long long task_cycle = 0, rest = 0;

  const Clock::time_point start = Clock::now();
  long long cycle = 0;
  for (; cycle < cycles && rest < cycles_at_rest; ++cycle) {
    const double t_s = static_cast<double>(cycle) * scene.period_s;
    const double task_time_s = static_cast<double>(task_cycle) * scene.period_s;
    read(robot, input);
    judgeChannels(robot, t_s, end);
    const Mode mode_before = mode;
    mode = modeAfter(mode_before, end.fault, state.retreat);
    applyMode(controller, mode, mode_before, input, scene.controller.gains, state);
    const Clock::time_point before = Clock::now();
    controller.update(input, scene.controller.gains, task_time_s, scene.period_s, state, output);
    record.step_ns = nanoseconds(Clock::now() - before);
    const Vector3 error = toolError(scene.controller.task, output.w_d, robot.toolPosition());
    noteFault(output, t_s, end);
    robot.write(output.velocity);
    fillRecord(t_s, input, scene.controller.gains, output, error, record);
    rotation_error.fill(record);
    record.task_time_s = task_time_s;
    if (state.tool_motion) record.tool_motion = state.tool_motion->plan();
    record.mode = static_cast<std::uint64_t>(mode);
    if (end.fault != Fault::kNone) record.fault = static_cast<std::uint64_t>(end.fault);
    sink(record);
    summary.add(record);
    task_cycle += mode == Mode::kRunning ? 1 : 0;
    rest = isAtRest(mode, end, output) ? rest + 1 : 0;
  }
  const double wall_s = 1e-9 * static_cast<double>(nanoseconds(Clock::now() - start));
  const double simulated_s = static_cast<double>(cycle) * scene.period_s;
  SimulationResult result{summary.figures(), simulated_s / wall_s};
  result.figures.end = end;
  if (const LinkContacts* links = robot.linkContacts()) result.figures.unsensed = links->largest();
  return result;
}

SimulationResult simulate(const Scene& scene, const std::string& log_path,
                          const Progress& progress) {
  UlogWriter log(log_path, describeLog(scene));
  long long cycle = 0;
  const SimulationResult result = simulate(scene, [&](const CycleRecord& record) {
    log.write(record);
    if (cycle++ % kCyclesBetweenReports == 0) progress(record.t_s / scene.duration_s);
  });
  log.close();
  return result;
}

}  // namespace tactus
