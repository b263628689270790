#include "tactus/bench/physics_trial.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <stdexcept>
#include <vector>

#include "tactus/bench/mujoco_robot.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus::physics {
namespace {

constexpr double kRest_s = 0.5;

/// Of this thread: another one's work is none of its own.
double processorTime_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double mean(const std::vector<double>& values, std::size_t last) {
  const std::size_t count = std::min(last, values.size());
  double sum = 0.0;
  for (std::size_t i = values.size() - count; i < values.size(); ++i) sum += values[i];
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

template <typename SomeRobot>
Trial follow(const Scene& scene, SomeRobot& robot) {
  const Controller controller(scene.controller);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  Trial trial;
  std::vector<double> forces_N;
  const double start_s = processorTime_s();
  for (long cycle = 0; trial.simulated_s < scene.duration_s && trial.fault == Fault::kNone;) {
    robot.read(input);
    controller.update(input, controller.initialGains(), trial.simulated_s, scene.period_s, state,
                      output);
    robot.write(output.velocity);
    forces_N.push_back(robot.trueForce_N());
    trial.peak_N = std::max(trial.peak_N, forces_N.back());
    trial.tool_error_m = std::max(trial.tool_error_m, output.error.norm());
    trial.fault = output.fault;
    trial.simulated_s = static_cast<double>(++cycle) * scene.period_s;
  }
  trial.run_time_s = processorTime_s() - start_s;
  trial.rest_N = mean(forces_N, static_cast<std::size_t>(std::lround(kRest_s / scene.period_s)));
  return trial;
}

}  // namespace

Trial tryOut(const Scene& scene, Plant plant, double step_s) {
  PlantConfig world = scene.plant;
  if (plant == Plant::kBuiltIn) {
    if (world.dynamics && step_s > 0.0) world.dynamics->step_s = step_s;
    SimulatedRobot robot(scene.controller, world, scene.period_s);
    return follow(scene, robot);
  }
  MujocoRobot robot = step_s > 0.0 ? MujocoRobot(scene.controller, world, scene.period_s, step_s)
                                   : MujocoRobot(scene.controller, world, scene.period_s);
  const Trial trial = follow(scene, robot);
  if (!robot.isSound()) throw std::runtime_error("MuJoCo's state was lost");
  return trial;
}

}  // namespace tactus::physics
