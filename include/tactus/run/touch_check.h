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

/// What the stiffest contact would come to at the fastest speed of a cover on its path: of several
/// modules, of the one that it brings nearest to what its sensor can show.
struct PeakReport {
  FastestCover fastest;
  double stiffness_N_per_m;  ///< c_e, obstacle and arm in series
  double delay_s, delay_peak_N;
  std::optional<double> mass_kg, blow_peak_N;  ///< only where the robot has dynamics
  double sensor_N;                             ///< that the sensor can show: see sensor_range.h
  double target_N, target_speed_m_per_s;       ///< F_act + F_th, or sensor_N without F_act

  double peak_N() const;
  double shareOfRange() const { return peak_N() / sensor_N; }
};

/// How fast an obstacle may come or go: at v_o the approach limit lets the force rest off F_act by
/// T m v_o, m being the stiffness that it counts on. Less where that is soft, see obstacle_speed.h.
struct MovingObstacle {
  double stiffness_N_per_m;  ///< m
  double speed_m_per_s;      ///< (F_act + F_th) / (2 T m)
  double force_N;            ///< at rest then: 1.5 (F_act + F_th)
};

struct ExpectedContact {
  std::vector<TouchReport> touches;      ///< only with force control
  std::optional<PeakReport> peak;        ///< only with force control and covers that move
  std::optional<MovingObstacle> moving;  ///< only with the approach limit
  std::vector<std::string> warnings;
};

/// stiffest_N_per_m: c_e, obstacle and arm in series.
ExpectedContact checkContacts(const Scene& scene, double stiffest_N_per_m);

}  // namespace tactus
