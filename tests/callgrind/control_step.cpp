#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstring>

#include "support/crops9.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

/// Runs scenario 2 with estimation, by the variant null_task or null_limit, and lets callgrind
/// collect the control step alone, in its contact cycles alone. Prints how many it collected.
int main(int argc, char** argv) {
  using namespace tactus;
  constexpr double kPeriod_s = 0.001;
  constexpr int kCycles = 9000;
  const bool is_limit = argc > 1 && std::strcmp(argv[1], "null_limit") == 0;
  const ControllerConfig config =
      test::crops9Controller(is_limit ? Variant::kNullLimit : Variant::kNullTask, true);
  const Controller controller(config);
  SimulatedRobot robot(config, test::crops9Plant(test::scenario2()), kPeriod_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  int collected = 0;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    robot.read(input);
    const bool in_contact = output.contact.force_contact_N > 0.0;
    if (in_contact) CALLGRIND_TOGGLE_COLLECT;
    controller.update(input, config.gains, cycle * kPeriod_s, kPeriod_s, state, output);
    if (in_contact) CALLGRIND_TOGGLE_COLLECT;
    robot.write(output.velocity);
    collected += in_contact;
  }
  std::printf("%d\n", collected);
  return 0;
}
