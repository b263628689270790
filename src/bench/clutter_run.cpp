#include <algorithm>
#include <cmath>
#include <vector>

#include "tactus/bench/clutter_grid.h"
#include "tactus/bench/spread.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

/// Of one post on one link.
double strongestContact_N(const SimulatedRobot& robot) {
  double strongest_N = 0.0;
  for (int i = 0; i < robot.modules(); ++i)
    strongest_N = std::max(strongest_N, robot.hardestContact_N(i));
  const LinkContacts* links = robot.linkContacts();
  for (int i = 0; links && i < links->capsules(); ++i)
    for (int k = 0; k < links->obstacles(); ++k)
      strongest_N = std::max(strongest_N, links->force_N(i, k));
  return strongest_N;
}

}  // namespace

ClutterRun runClutter(const RunSetup& setup) {
  const Controller controller(setup.controller);
  SimulatedRobot robot(setup.controller, setup.plant, setup.period_s);
  const ForceGains& force = setup.controller.gains.force;
  const double high_N = ClutterRun::kHigh * (force.activation_force_N + force.contact_threshold_N);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  ClutterRun run;
  std::vector<Spread> rest(static_cast<std::size_t>(robot.modules()));
  const long cycles = std::lround(setup.duration_s / setup.period_s);
  const long rest_from = cycles - std::lround(JudgedRun::kRest_s / setup.period_s);
  for (long cycle = 0; cycle < cycles; ++cycle) {
    robot.read(input);
    controller.update(input, setup.controller.gains, static_cast<double>(cycle) * setup.period_s,
                      setup.period_s, state, output);
    const Vector3 tip = robot.toolPosition();
    run.tcp_error_final_m = std::hypot(output.w_d[0] - tip.x(), output.w_d[1] - tip.y());
    robot.write(output.velocity);
    const double contact_N = strongestContact_N(robot);
    run.largest_N = std::max(run.largest_N, contact_N);
    if (contact_N > 0.0) run.contact_s += setup.period_s;
    if (contact_N > high_N) run.high_s += setup.period_s;
    if (cycle < rest_from) continue;
    run.largest_at_rest_N = std::max(run.largest_at_rest_N, contact_N);
    for (int i = 0; i < robot.modules(); ++i) {
      run.largest_felt_at_rest_N = std::max(run.largest_felt_at_rest_N, output.sensed[i].force_N);
      rest[i].add(robot.trueForce_N(i));
    }
  }
  for (const Spread& one : rest) run.restlessness_N = std::max(run.restlessness_N, one.deviation());
  run.fault = output.fault;
  return run;
}

}  // namespace tactus
