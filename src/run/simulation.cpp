#include "tactus/run/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tactus/record/tool_error.h"
#include "tactus/record/ulog_writer.h"
#include "tactus/run/virtual_cycle.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

using Clock = std::chrono::steady_clock;

/// After a fault, until sensors tell what is left of the force.
constexpr double kRest_s = 0.3;
constexpr long long kCyclesBetweenReports = 8192;
constexpr long long kMaxReservedCycles = 1'000'000;

std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

/// The newest that the module does not call none, as the daemon's receivers take them, and the
/// fault that they find in the counts of the newest.
void read(SimulatedRobot& robot, VirtualCycle& cycle, RobotInput& input) {
  const auto before = input.tactile;
  robot.read(input);
  for (int i = 0; i < robot.modules(); ++i) {
    if (!robot.module(i).isSaturated()) continue;
    input.tactile[i] = before[i];
    cycle.note(Fault::kTactileSaturated, i);
  }
}

}  // namespace

std::size_t cyclesToReserve(const Scene& scene) {
  const long long cycles = std::llround(scene.duration_s / scene.period_s);
  return static_cast<std::size_t>(std::min(cycles, kMaxReservedCycles));
}

SimulationResult simulate(const Scene& scene, const CycleSink& sink, FigureSet set) {
  const auto cycles = std::llround(scene.duration_s / scene.period_s);
  const auto cycles_at_rest = std::llround(kRest_s / scene.period_s);
  VirtualCycle cycle(scene);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  RunSummary summary(scene.controller, cyclesToReserve(scene), set);
  ToolRotationError rotation_error(scene.controller);
  RobotInput input;
  CycleRecord record;

  const bool is_timed = set == FigureSet::kAll;
  const Clock::time_point start = Clock::now();
  long long done = 0, rest = 0;
  for (; done < cycles && rest < cycles_at_rest; ++done) {
    read(robot, cycle, input);
    const Clock::time_point before = is_timed ? Clock::now() : start;
    cycle.update(input);
    if (is_timed) record.step_ns = nanoseconds(Clock::now() - before);
    const ControllerOutput& output = cycle.output();
    const Vector3 error = toolError(scene.controller.task, output.w_d, robot.toolPosition());
    robot.write(output.velocity);
    cycle.fill(input, error, record);
    rotation_error.fill(record);
    sink(record);
    summary.add(record);
    rest = cycle.isAtRest() ? rest + 1 : 0;
  }
  const double wall_s = 1e-9 * static_cast<double>(nanoseconds(Clock::now() - start));
  const double simulated_s = static_cast<double>(done) * scene.period_s;
  SimulationResult result{summary.figures(), simulated_s / wall_s};
  result.figures.end = cycle.end();
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
