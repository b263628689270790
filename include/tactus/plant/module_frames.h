#pragma once

#include <array>
#include <cstdint>

#include "tactus/canopen/can_frame.h"

namespace tactus {

/// Channels of the tactile module, signed 24 bits.
using ModuleCounts = std::array<std::int32_t, 8>;

inline constexpr std::int32_t kModuleFullScale = 8388607;

enum ModuleStatus : std::uint8_t { kModuleSaturated = 1, kModuleCableBreak = 2 };

/// A sample as the module sends it: frames first_id + k, k = 0..3, of sequence, status and channels
/// 2k and 2k + 1, little-endian. Counts beyond full scale saturate; so does the status then.
std::array<CanFrame, 4> moduleFrames(std::uint32_t first_id, std::uint8_t sequence,
                                     const ModuleCounts& counts, bool is_cable_broken) noexcept;

}  // namespace tactus
