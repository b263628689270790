#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/analysis/path_contacts.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A lower force, and what it takes.
struct SofterTouch {
  double force_N;
  double speed_m_per_s;
  std::optional<double> cutoff_hz;  ///< of the sensor's filter at the speed as it is, if any does
};

/// The first touch of an obstacle of the simulation: see contact_peak.h.
struct TouchReport {
  int obstacle;
  PathTouch touch;
  double peak_N;
  std::optional<SofterTouch> softer;
};

/// What the stiffest contact would come to at the fastest speed of the covers on their path.
struct PeakReport {
  FastestCover fastest;
  double stiffness_N_per_m;  ///< c_e, obstacle and arm in series
  double delay_s, delay_peak_N;
  std::optional<double> mass_kg, blow_peak_N;  ///< only where the robot has dynamics
  double max_force_N;                          ///< of the sensor
  double target_N, target_speed_m_per_s;       ///< F_act + F_th, or max_force_N without F_act

  double peak_N() const;
};

struct ExpectedContact {
  std::vector<TouchReport> touches;  ///< only with force control
  std::optional<PeakReport> peak;    ///< only with force control and covers that move
  std::vector<std::string> warnings;
};

/// stiffest_N_per_m: c_e, obstacle and arm in series.
ExpectedContact checkContacts(const Scene& scene, double stiffest_N_per_m);

}  // namespace tactus
