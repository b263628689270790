#pragma once

#include "support/period.h"
#include "support/rail_robot.h"

/// The answer to one contact, on a rail where all of it can be told by hand: nothing delays or
/// filters, and c is known.
namespace tactus::test {

inline constexpr double kOneT_s = 0.1;
inline constexpr double kOneC_N_per_m = 1000.0;
inline constexpr double kOneThreshold_N = 1.2;
inline constexpr double kOneAct_N = 3.8;

inline ControllerConfig oneContactRail(double speed_m_per_s, double friction_coefficient = 0.0) {
  ControllerConfig config = undelayedRail(speed_m_per_s, kOneC_N_per_m);
  config.force_control->friction_coefficient = friction_coefficient;
  config.gains.force.contact_threshold_N = kOneThreshold_N;
  config.gains.force.activation_force_N = kOneAct_N;
  return config;
}

/// A wall that is far away, but watched in every cycle.
inline void addFarWall(ControllerConfig& config) {
  ClearanceConfig& clear = config.clearance.emplace();
  LinkCapsule ball;
  ball.link.joint = 0;
  ball.radius_m = 0.05;
  clear.capsules = {ball};
  clear.walls = {HalfSpace{100.0 * Vector3::UnitY(), -Vector3::UnitY()}};
  clear.wall_pairs = {{0, 0}};
}

struct OneContactRun {
  explicit OneContactRun(const ControllerConfig& c) : config(c) {}
  /// A sample of a force from +y, or from so much beside it.
  void press(double force_N, double position_m = 0.5, double angle_rad = 0.0) {
    const std::uint32_t next = state.modules[0].sequence + 1;
    controller.update({state.q_desired, {touchAt(position_m, -force_N, angle_rad, next)}},
                      config.gains, cycle++ * kPeriod_s, kPeriod_s, state, output);
  }
  void pressFor(int cycles, double force_N) {
    for (int i = 0; i < cycles; ++i) press(force_N);
  }

  ControllerConfig config;
  Controller controller{config};
  ControllerState state = controller.initialState();
  ControllerOutput output;
  int cycle = 0;
};

}  // namespace tactus::test
