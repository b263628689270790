#include "tactus/bench/law_trials.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus {
namespace {

constexpr double kSaturation_N = 20.0;
constexpr double kMoved_s = 7.0;  ///< a moving obstacle is then where it stands in the base
constexpr double kFarAway_m = 10.0;

/// Each component of the force as the module reads it.
void addNoise(double sigma_N, RunSetup& setup) {
  setup.plant.modules[0].noise_N =
      sigma_N / setup.plant.modules[0].channels.calibration.row(0).norm();
}

void sampleEvery(double period_s, RunSetup& setup) {
  setup.plant.modules[0].channels.sample_period_s = period_s;
  setup.controller.tactile_modules.front().max_sample_age_s = 5.0 * period_s;
}

void shiftContact(double shift_m, RunSetup& setup) {
  setup.reading = [shift_m](TactileSample& sample) {
    sample.moment_y_Nm -= shift_m * sample.force_z_N;
    sample.moment_z_Nm += shift_m * sample.force_y_N;
  };
}

void saturate(TactileSample& sample) {
  const double force_N = std::hypot(sample.force_y_N, sample.force_z_N);
  const double share = std::min(1.0, kSaturation_N / force_N);
  for (double* value :
       {&sample.force_y_N, &sample.force_z_N, &sample.moment_y_Nm, &sample.moment_z_Nm})
    *value *= share;
}

/// The profile at a steady speed along y, against the arm if negative: the beginning of a swing so
/// wide that its speed is the same within 0.2 % for two minutes.
void move(double speed_m_per_s, RunSetup& setup) {
  ObstacleConfig& profile = setup.plant.obstacles.back();
  profile.y_m -= kMoved_s * speed_m_per_s;
  const double way_m = std::copysign(kFarAway_m, speed_m_per_s);
  profile.swing = {0.0, way_m, speed_m_per_s / (2.0 * std::numbers::pi * way_m)};
}

void swing(double way_m, double frequency_hz, RunSetup& setup) {
  setup.plant.obstacles.back().swing = {0.0, way_m, frequency_hz};
}

}  // namespace

std::vector<LawTrial> lawDisturbances() {
  return {
      {"none", [](RunSetup&) {}},
      {"force noise 0.05 N", [](RunSetup& s) { addNoise(0.05, s); }},
      {"force noise 0.1 N", [](RunSetup& s) { addNoise(0.1, s); }},
      {"samples every 8 ms", [](RunSetup& s) { sampleEvery(0.008, s); }},
      {"samples every 20 ms", [](RunSetup& s) { sampleEvery(0.020, s); }},
      {"contact point +2 cm", [](RunSetup& s) { shiftContact(0.02, s); }},
      {"contact point -2 cm", [](RunSetup& s) { shiftContact(-0.02, s); }},
      {"sensor saturates at 20 N", [](RunSetup& s) { s.reading = saturate; }},
      {"profile comes at 5 mm/s", [](RunSetup& s) { move(-0.005, s); }},
      {"profile goes at 5 mm/s", [](RunSetup& s) { move(0.005, s); }},
      {"profile swings 1 mm at 0.5 Hz", [](RunSetup& s) { swing(0.001, 0.5, s); }},
  };
}

std::vector<LawTrial> lawAblations() {
  return {
      {"without the estimator",
       [](RunSetup& s) {
         if (s.controller.force_control->variant == Variant::kNullLimit)
           s.controller.force_control->has_estimator = false;
       }},
      {"without c_floor",
       [](RunSetup& s) { s.controller.gains.force.min_approach_stiffness_N_per_m = 0.0; }},
  };
}

}  // namespace tactus
