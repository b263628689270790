#pragma once

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "tactus/analysis/stability_margins.h"
#include "tactus/scene/scene.h"

namespace tactus {

inline constexpr double kMinPhaseMargin_deg = 30.0;  ///< below: a warning

struct LoopReport {
  std::string name;
  StabilityMargins margins;  ///< of rigid gears
  /// The largest c_e/c with masses, servos and gears at the start; of loops of one space, once
  /// addGearMargins() was asked.
  std::optional<double> ratio_with_gears{};
  int module_with_gears = 0;  ///< of several the one whose that is, the smallest

  double phaseMargin_deg() const { return margins.phase_margin_rad * 180.0 / std::numbers::pi; }
};

/// How stable a scene's force control is in its stiffest contact.
struct StabilityReport {
  double stiffest_N_per_m = 0.0;   ///< c_e: declared or assumed, or of a stiffer simulated obstacle
  double stiffness_N_per_m = 0.0;  ///< c: assumed, or where the estimate of c_e ends
  std::vector<LoopReport> loops;   ///< empty where the margins can't be computed; then a warning
  int module = 0;                  ///< whose they are: of several the least stable one
  /// Of all modules' loops the one with the smallest phase margin; absent where loops is empty.
  std::optional<LoopReport> nearest;
  int module_of_nearest = 0;
  /// The links' first mode behind motors held fast, where gears are known.
  std::optional<double> gear_mode_hz;
  std::vector<std::string> warnings;

  double ratio() const { return stiffest_N_per_m / stiffness_N_per_m; }
};

/// " of link6" where the scene reads several modules, else nothing.
std::string ofModule(const Scene& scene, int module);

/// Absent for a scene without force control. Throws InputError if one of its loops is unstable in
/// that contact. Not a part of loading: simulations and replays of unstable gains are of use.
std::optional<StabilityReport> checkStability(const Scene& scene);

/// The smallest of all its loops, of all modules; infinite where there is none, or none can be
/// computed; 0 where one is unstable.
double phaseMargin_deg(const Scene& scene);

/// Throws InputError where checkStability() does, and where that is less; it says which T would do.
void requirePhaseMargin(const Scene& scene, double least_deg);

/// Of the simulation's obstacles with links and cover; gears are apart. 0: there are none. Needs
/// scene.arm.
double stiffestBeforeGears(const Scene& scene);

/// What masses, servos and gears leave of the ratios, where robot.yaml knows them: takes some 0.2
/// s. Beyond it only a warning, for in contact the arm may stand elsewhere than at its start.
void addGearMargins(const Scene& scene, StabilityReport& report);

}  // namespace tactus
