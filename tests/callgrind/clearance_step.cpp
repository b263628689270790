#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstring>

#include "support/crops9.h"
#include "tactus/control/clearance.h"
#include "tactus/control/controller.h"

/// Lets callgrind collect, in each cycle of the nine-joint arm's task, what 28 pairs of capsules
/// cost: what is near, whether the motion keeps it, and whether the arm can stop. With the argument
/// `near` as many as there can be are near. Prints how many cycles it collected.
int main(int argc, char** argv) {
  using namespace tactus;
  constexpr double kPeriod_s = 0.001;
  constexpr int kCycles = 9000;
  ControllerConfig config = test::crops9Controller();
  const Controller controller(config);
  ClearanceConfig& bodies = config.clearance.emplace();
  const double lengths_m[] = {0.1, 0.12, 0.23, 0.38, 0.12, 0.18, 0.15, 0.12, 0.15};
  for (int i = 0; i < 9; ++i)
    bodies.capsules.push_back({{i, {}}, Vector3::Zero(), Vector3(lengths_m[i], 0.0, 0.0), 0.04});
  for (int a = 0; a < 9; ++a)
    for (int b = a + 2; b < 9; ++b) bodies.pairs.push_back({a, b});
  if (argc > 1 && std::strcmp(argv[1], "near") == 0) bodies.influence_distance_m = 10.0;
  const Clearance clearance(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    PreparedCycle prepared;
    controller.prepare(config.gains, cycle * kPeriod_s, state, prepared);
    TaskKinematics& kinematics = prepared.kinematics;
    const ScaledVector velocity =
        prepared.motion.v_scaled + kinematics.pseudoinverse.expand(prepared.motion.y);
    CALLGRIND_TOGGLE_COLLECT;
    clearance.findNear(kinematics.pose, kinematics.near);
    clearance.isKept(kinematics.pose, kinematics.near, velocity, state.q_desired,
                     state.velocity_before, kPeriod_s);
    clearance.canStopAfter(kinematics.pose, kinematics.near, state.q_desired, state.velocity_before,
                           kPeriod_s);
    CALLGRIND_TOGGLE_COLLECT;
    controller.update({state.q_desired, {}}, config.gains, cycle * kPeriod_s, kPeriod_s, state,
                      output);
  }
  std::printf("%d\n", kCycles);
  return 0;
}
