#include "tactus/bench/body_trial.h"

#include <cmath>

#include "tactus/bench/law_grid.h"
#include "tactus/bench/table.h"
#include "tactus/sim/obstacle.h"

namespace tactus {
namespace {

constexpr double kBodyFriction = 0.3;
constexpr double kBodyBearable = 0.5;
constexpr double kAfterMotion_s = 6.0;

/// Of an arm without mass that nothing answers, at so many times the base's speed.
double touchSpeed_m_per_s(const RunSetup& base, double factor) {
  RunSetup setup = lawGridSetup(base, {0.0, 1.0, kNoLimit, factor}, GridLaw::kLimited);
  setup.controller.force_control->variant = Variant::kNone;
  setup.plant.dynamics.reset();
  return judgeRun(setup).touch_speed_m_per_s;
}

/// Nearly in proportion, but for the ramps of the path and the lag behind it.
double speedFactor(const RunSetup& base, double speed_m_per_s) {
  double factor = 1.0;
  for (int i = 0; i < 3; ++i) factor *= speed_m_per_s / touchSpeed_m_per_s(base, factor);
  return factor;
}

}  // namespace

RunSetup bodySetup(const RunSetup& base, const BodyTrial& trial) {
  const double factor = speedFactor(base, trial.speed_m_per_s);
  RunSetup setup = lawGridSetup(base, {0.0, trial.region.stiffness_N_per_m, kNoLimit, factor},
                                GridLaw::kLimited);
  if (base.plant.dynamics) setup.plant.robot_stiffness_N_per_m = base.plant.robot_stiffness_N_per_m;
  setup.controller.force_control->variant = trial.law;
  setup.controller.force_control->friction_coefficient =
      trial.law == Variant::kNullLimit ? kBodyBearable : 0.0;
  setup.plant.obstacles.front().friction_coefficient = kBodyFriction;
  const TrajectoryConfig& trajectory = setup.controller.task.trajectory;
  const Waypoint& line = trajectory.waypoints.front();
  setup.duration_s = trajectory.start_s + line.displacement_m.norm() / line.speed_m_per_s +
                     line.ramp_s + kAfterMotion_s;
  return setup;
}

double freeBlow_N(const RunSetup& setup, const BodyTrial& trial, const JudgedRun& run) {
  if (run.touch_mass_kg <= 0.0) return kNotMeasured;
  const double stiffness =
      inSeries(trial.region.stiffness_N_per_m, setup.plant.robot_stiffness_N_per_m);
  const double mass_kg = inSeries(trial.region.mass_kg, run.touch_mass_kg);
  return run.touch_speed_m_per_s * std::sqrt(stiffness * mass_kg);
}

}  // namespace tactus
