#include "tactus/plant/module_frames.h"

#include <algorithm>
#include <cstdlib>

namespace tactus {
namespace {

void put24(std::uint8_t* bytes, std::int32_t counts) {
  const auto value =
      static_cast<std::uint32_t>(std::clamp(counts, -kModuleFullScale, kModuleFullScale));
  for (int i = 0; i < 3; ++i) bytes[i] = static_cast<std::uint8_t>(value >> 8 * i);
}

bool isSaturated(std::int32_t counts) {
  return counts <= -kModuleFullScale || counts >= kModuleFullScale;
}

}  // namespace

std::array<CanFrame, 4> moduleFrames(std::uint32_t first_id, std::uint8_t sequence,
                                     const ModuleCounts& counts, bool is_cable_broken) noexcept {
  unsigned status = is_cable_broken ? unsigned{kModuleCableBreak} : 0U;
  if (std::any_of(counts.begin(), counts.end(), isSaturated)) status |= kModuleSaturated;
  std::array<CanFrame, 4> frames;
  for (unsigned k = 0; k < frames.size(); ++k) {
    CanFrame& frame = frames[k];
    frame.id = first_id + k;
    frame.size = 8;
    frame.data[0] = sequence;
    frame.data[1] = static_cast<std::uint8_t>(status);
    put24(&frame.data[2], counts[2 * k]);
    put24(&frame.data[5], counts[2 * k + 1]);
  }
  return frames;
}

}  // namespace tactus
