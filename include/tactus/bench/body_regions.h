#pragma once

#include <span>

namespace tactus {

/// A region of the body as ISO/TS 15066:2016 models it: a spring, and the force that its areas may
/// be pressed with while they cannot get away. No pressures: they need the shape of what presses.
struct BodyRegion {
  const char* name;
  int areas;  ///< of the 29 whose force this is
  double stiffness_N_per_m;
  double mass_kg;      ///< that a blow moves, if the region is free
  double max_force_N;  ///< quasi-static
};

/// Twelve. Of public copies: epfl-lasa/human-robot-collider has springs and masses, yih0nk/cotter
/// springs and forces (and other masses of legs), published controllers that limit power and force
/// have both tables. They agree; other copies have 210 N for the pelvis, and 180 N for lower legs.
std::span<const BodyRegion> bodyRegions() noexcept;

}  // namespace tactus
