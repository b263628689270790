#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/one_contact_run.h"

/// Contacts with rows of their own, on the rail of one_contact_run.h.
namespace tactus::test {

struct RowsOf {
  LimitAt limit_at;
  double friction_coefficient;
};
inline constexpr RowsOf kRowsOf[] = {{LimitAt::kStiffnessCentre, 0.0},
                                     {LimitAt::kModuleEnds, 0.0},
                                     {LimitAt::kStiffnessCentre, 0.5},
                                     {LimitAt::kModuleEnds, 0.5}};

inline ControllerConfig rowsRail(const RowsOf& rows, double speed_m_per_s) {
  ControllerConfig config = oneContactRail(speed_m_per_s, rows.friction_coefficient);
  config.force_control->limit_at = rows.limit_at;
  return config;
}

/// A controller and an obstacle at +y of its first carriage.
struct RowsRun {
  RowsRun(const ControllerConfig& c, double surface_m)
      : config(c), world{kOneC_N_per_m, surface_m} {}
  void step() {
    controller.update(world.input(state), config.gains, cycle++ * kPeriod_s, kPeriod_s, state,
                      output);
  }
  /// Samples of forces from +y, one for each module, whatever the obstacle says.
  void press(const std::vector<double>& forces_N) {
    RobotInput input{state.q_desired, {}};
    for (std::size_t i = 0; i < forces_N.size(); ++i)
      input.tactile[i] = touchAt(0.5, -forces_N[i], 0.0, state.modules[i].sequence + 1);
    controller.update(input, config.gains, cycle++ * kPeriod_s, kPeriod_s, state, output);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
  }
  double force_N() const { return world.force_N(state.q_desired); }
  /// dF/dt = -(F - end_N) / T, one explicit step of it each cycle.
  void expectDecay(double end_N, int cycles) {
    for (int i = 0; i < cycles; ++i) {
      const double before_N = force_N();
      step();
      const double expected_N = -kPeriod_s / kOneT_s * (before_N - end_N);
      ASSERT_NEAR(force_N() - before_N, expected_N, 0.06 * std::abs(expected_N) + 1e-5) << i;
    }
  }
  /// How fast the memory of the first module's contact fades, 1/s, once it is being forgotten.
  double forgetting_per_s(int cycles = 100) {
    const double first = memory();
    run(cycles);
    return std::log(first / memory()) / (cycles * kPeriod_s);
  }
  double memory() const { return state.several.modules[0].approach.memory_N_per_m; }

  ControllerConfig config;
  Controller controller{config};
  RailWorld world;
  ControllerState state = controller.initialState();
  ControllerOutput output;
  int cycle = 0;
};

}  // namespace tactus::test
