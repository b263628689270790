#pragma once

#include <array>
#include <cstdint>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"

/// The tactile module's side, written from its description and apart from the receiver.
namespace tactus::test {

using Counts = std::array<std::int32_t, 8>;
using TactileFrames = std::array<CanFrame, 4>;

inline TactileFrames tactileFrames(int sequence, const Counts& counts, std::uint8_t status = 0) {
  TactileFrames frames;
  for (std::uint32_t k = 0; k < 4; ++k) {
    frames[k].id = 0x100 + k;
    frames[k].size = 8;
    frames[k].data = {static_cast<std::uint8_t>(sequence), status};
    for (std::size_t i = 0; i < 6; ++i) {
      const auto bits = static_cast<std::uint32_t>(counts[2 * k + i / 3]);
      frames[k].data[2 + i] = static_cast<std::uint8_t>(bits >> 8 * (i % 3));
    }
  }
  return frames;
}

/// F_y and F_z are the differences of two channels each, at 0.1 m and 0.3 m along the link; 1000
/// counts a newton.
inline CanTactileConfig tactileConfig() {
  CanTactileConfig config;
  config.channels.counts_per_N = 1000.0;
  for (int end = 0; end < 2; ++end) {
    const double x_m = end == 0 ? 0.1 : 0.3;
    config.channels.calibration.col(4 * end + 0) << 1, 0, 0, x_m;
    config.channels.calibration.col(4 * end + 1) << -1, 0, 0, -x_m;
    config.channels.calibration.col(4 * end + 2) << 0, 1, -x_m, 0;
    config.channels.calibration.col(4 * end + 3) << 0, -1, x_m, 0;
  }
  return config;
}

}  // namespace tactus::test
