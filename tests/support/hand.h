#pragma once

#include <cmath>
#include <cstdint>

#include "tactus/canopen/can_frame.h"

namespace tactus::test {

/// A hand on the cover of the reference robot's module, on its frames on their way to the daemon:
/// at the middle of the two rings of cells, along +y (`along_y`) or +z of the link.
struct Hand {
  double force_N = 0.0;
  bool along_y = true;

  void push(int bus, CanFrame& frame) const {
    const bool is_first = frame.id == (along_y ? 0x100u : 0x101u);
    const bool is_second = frame.id == (along_y ? 0x102u : 0x103u);
    if (bus != 3 || (!is_first && !is_second)) return;
    constexpr double kCountsPerN = 1e5;
    const auto bits =
        static_cast<std::uint32_t>(frame.data[2] | frame.data[3] << 8 | frame.data[4] << 16);
    const int counts = static_cast<int>(bits ^ 0x800000U) - 0x800000 +
                       static_cast<int>(std::lround(0.5 * force_N * kCountsPerN));
    for (int i = 0; i < 3; ++i)
      frame.data[2 + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(counts) >> (8 * i));
  }
};

}  // namespace tactus::test
