#include "tactus/bench/judged_run.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/analysis/effective_mass.h"
#include "tactus/bench/spread.h"
#include "tactus/control/controller.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

/// The last obstacle alone, to see when the arm meets it and how fast.
class ProfileProbe {
 public:
  explicit ProfileProbe(const RunSetup& setup)
      : chain_(setup.controller.chain),
        module_(setup.controller.tactile_modules.front()),
        radius_m_(setup.plant.modules[0].cover_radius_m),
        obstacle_({setup.plant.obstacles.back().x_m,
                   setup.plant.obstacles.back().y_m,
                   1.0,
                   {},
                   setup.plant.obstacles.back().appears_s,
                   setup.plant.obstacles.back().vanishes_s,
                   setup.plant.obstacles.back().swing},
                  kNoLimit) {}

  /// Its force is the way that the arm has gone into the obstacle, in m.
  ObstacleContact touch(const JointVector& q, double t_s) {
    chain_.computePose(q, pose_);
    const Pose X = framePose(pose_, module_.link);
    return obstacle_.touch({X.p_AB, X.R_AB.col(0), module_.length_m, radius_m_}, t_s);
  }

  /// Of the last touch, kg.
  double mass_kg(const ArmDynamicsConfig& arm, const JointVector& q,
                 const ObstacleContact& touch) const {
    const Pose X = framePose(pose_, module_.link);
    const JointVector rotors = arm.gear_stiffness.array().isFinite().select(0.0, arm.rotor_inertia);
    return effectiveMass_kg(chain_, pose_, massMatrixAt(chain_, arm.bodies, q), rotors,
                            module_.link.joint, X.p_AB + touch.position_m * X.R_AB.col(0),
                            touch.force_Base.normalized());
  }

 private:
  SerialChain chain_;
  TactileModuleConfig module_;
  double radius_m_;
  Obstacle obstacle_;  ///< of 1 N/m
  ChainPose pose_{};
};

}  // namespace

JudgedRun judgeRun(const RunSetup& setup) {
  const Controller controller(setup.controller);
  SimulatedRobot robot(setup.controller, setup.plant, setup.period_s);
  ProfileProbe probe(setup);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  JudgedRun run;
  Spread last_readings, last_forces;
  double depth_m = 0.0;  // in the profile, a cycle before
  const long cycles = std::lround(setup.duration_s / setup.period_s);
  const long rest_from = cycles - std::lround(JudgedRun::kRest_s / setup.period_s);
  for (long cycle = 0; cycle < cycles; ++cycle) {
    const double t_s = static_cast<double>(cycle) * setup.period_s;
    robot.read(input);
    if (setup.reading) setup.reading(input.tactile[0]);
    if (setup.watch) setup.watch(input.q_measured, t_s);
    controller.update(input, setup.controller.gains, t_s, setup.period_s, state, output);
    const Vector3 goal = output.w_d.size() >= 3 ? Vector3(output.w_d.head<3>()) : Vector3::Zero();
    run.tcp_error_final_m = (goal - robot.toolPosition()).norm();
    robot.write(output.velocity);
    run.peak_force_N = std::max(run.peak_force_N, output.sensed[0].force_N);
    run.peak_true_force_N = std::max(run.peak_true_force_N, robot.trueForce_N());
    if (cycle >= rest_from) {
      last_readings.add(output.sensed[0].force_N);
      last_forces.add(robot.trueForce_N());
      run.peak_at_rest_N = std::max(run.peak_at_rest_N, robot.trueForce_N());
    }
    if (run.touch_speed_m_per_s > 0.0) continue;
    const ObstacleContact touch = probe.touch(input.q_measured, t_s);
    if (depth_m > 0.0 && touch.force_N > depth_m) {
      run.touch_speed_m_per_s = (touch.force_N - depth_m) / setup.period_s;
      run.touch_force_N = output.contact.force_contact_N;
      if (setup.plant.dynamics)
        run.touch_mass_kg = probe.mass_kg(*setup.plant.dynamics, input.q_measured, touch);
    }
    depth_m = touch.force_N;
  }
  run.final_force_N = last_readings.mean;
  run.restlessness_N = last_forces.deviation();
  run.fault = output.fault;
  return run;
}

double feedbackDelay_s(const PlantConfig& plant) {
  // A 3rd-order Butterworth filter delays slow signals by 2 / w_c.
  return plant.drive_lag_s + 1.0 / (std::numbers::pi * plant.modules[0].filter_cutoff_hz) +
         0.5 * plant.modules[0].channels.sample_period_s;
}

double naturalScale(const RunSetup& setup, const JudgedRun& run) {
  const ForceGains& force = setup.controller.gains.force;
  // Of the obstacle without its foam. A blow is over before gears and servos give way.
  const double stiffness =
      inSeries(setup.plant.obstacles.back().stiffness_N_per_m, setup.plant.robot_stiffness_N_per_m);
  const double yielding = inSeries(stiffness, setup.arm_stiffness_N_per_m);
  const double unseen_N = yielding * run.touch_speed_m_per_s * feedbackDelay_s(setup.plant);
  const double blow_N = run.touch_speed_m_per_s * std::sqrt(stiffness * run.touch_mass_kg);
  return force.contact_threshold_N +
         std::max({force.activation_force_N, run.touch_force_N + unseen_N, blow_N});
}

}  // namespace tactus
