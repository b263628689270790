#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstdlib>

#include "support/crops9.h"
#include "support/tactile_samples.h"
#include "tactus/control/controller.h"

/// The control step of a nine-joint arm with so many modules, pushed on so many of them with what
/// level 2 answers. Lets callgrind collect the steps in contact alone. Prints how many there were.
int main(int argc, char** argv) {
  using namespace tactus;
  constexpr double kPeriod_s = 0.001;
  const int modules = argc > 1 ? std::atoi(argv[1]) : 3;
  const int contacts = argc > 2 ? std::atoi(argv[2]) : modules;
  ControllerConfig config = test::crops9Controller(Variant::kNullLimit, true);
  const TactileModuleConfig module = config.tactile_modules.front();
  config.tactile_modules.clear();
  for (int i = 0; i < modules; ++i) {
    config.tactile_modules.push_back(module);
    config.tactile_modules.back().link.joint = 8 - i;
    config.tactile_modules.back().length_m = 0.15;
  }
  const Controller controller(config);
  int collected = 0;
  for (int touch = 0; touch < 60; ++touch) {
    ControllerState state = controller.initialState();
    ControllerOutput output;
    RobotInput input;
    input.q_measured = config.q_start;
    for (int cycle = 0; cycle < 60; ++cycle) {
      for (int i = 0; i < modules; ++i) {
        const double force_N = i < contacts ? 4.0 + 0.05 * cycle : 0.0;
        const double angle = 0.3 * touch + 0.8 * i;
        input.tactile[i] = test::touchAt(0.07, force_N, angle, 1 + cycle / 4);
      }
      const bool is_counted = cycle >= 20;
      if (is_counted) CALLGRIND_TOGGLE_COLLECT;
      controller.update(input, config.gains, cycle * kPeriod_s, kPeriod_s, state, output);
      if (is_counted) CALLGRIND_TOGGLE_COLLECT;
      collected += is_counted;
    }
  }
  std::printf("%d\n", collected);
  return 0;
}
