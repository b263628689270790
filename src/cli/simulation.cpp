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

/// What a controller finds in its own input it answers itself; any other fault is the mode's.
Mode modeAfter(Fault fault) {
  return fault == Fault::kTactileSaturated ? Mode::kHolding : Mode::kRunning;
}

bool isOver(const FaultReport& end, const ControllerOutput& output) {
  return end.fault != Fault::kNone && output.velocity.isZero(0.0);
}

}  // namespace

SimulationResult simulate(const Scene& scene, const CycleSink& sink) {
  const auto cycles = std::llround(scene.duration_s / scene.period_s);
  const Controller controller(scene.controller);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  RunSummary summary(scene.controller,
                     static_cast<std::size_t>(std::min(cycles, kMaxReservedCycles)));
  ControllerState state = controller.initialState();
  const ToolRotationError rotation_error(scene.controller);
  RobotInput input;
  ControllerOutput output;
  CycleRecord record;
  FaultReport end;

  const Clock::time_point start = Clock::now();
  long long cycle = 0;
  for (; cycle < cycles && !isOver(end, output); ++cycle) {
    const double t_s = static_cast<double>(cycle) * scene.period_s;
    robot.read(input);
    const Mode mode_before = modeAfter(end.fault);
    judgeChannels(robot, t_s, end);
    const Mode mode = modeAfter(end.fault);
    applyMode(controller, mode, mode_before, input, scene.controller.gains, state);
    const Clock::time_point before = Clock::now();
    controller.update(input, scene.controller.gains, t_s, scene.period_s, state, output);
    record.step_ns = nanoseconds(Clock::now() - before);
    const Vector3 error = toolError(scene.controller.task, output.w_d, robot.toolPosition());
    noteFault(output, t_s, end);
    robot.write(output.velocity);
    fillRecord(t_s, input, scene.controller.gains, output, error, record);
    rotation_error.fill(record);
    record.mode = static_cast<std::uint64_t>(mode);
    if (end.fault != Fault::kNone) record.fault = static_cast<std::uint64_t>(end.fault);
    sink(record);
    summary.add(record);
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
