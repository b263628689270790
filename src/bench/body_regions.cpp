#include "tactus/bench/body_regions.h"

#include <array>

namespace tactus {

std::span<const BodyRegion> bodyRegions() noexcept {
  static constexpr auto kRegions = std::to_array<BodyRegion>({
      {"skull and forehead", 2, 150e3, 4.4, 130.0},
      {"face", 1, 75e3, 4.4, 65.0},
      {"neck", 2, 50e3, 1.2, 150.0},
      {"back and shoulders", 2, 35e3, 40.0, 210.0},
      {"chest", 2, 25e3, 40.0, 140.0},
      {"abdomen", 1, 10e3, 40.0, 110.0},
      {"pelvis", 1, 25e3, 40.0, 180.0},
      {"upper arms and elbows", 2, 30e3, 3.0, 150.0},
      {"lower arms and wrists", 3, 40e3, 2.0, 160.0},
      {"hands and fingers", 9, 75e3, 0.6, 140.0},
      {"thighs and knees", 2, 50e3, 75.0, 220.0},
      {"lower legs", 2, 60e3, 75.0, 130.0},
  });
  return kRegions;
}

}  // namespace tactus
