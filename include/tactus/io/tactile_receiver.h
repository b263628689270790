#pragma once

#include <cstdint>

#include "tactus/control/fault.h"
#include "tactus/control/robot.h"
#include "tactus/io/can_frame.h"
#include "tactus/io/hardware_config.h"

namespace tactus {

enum class TareState : std::uint8_t { kNone, kAveraging, kDone, kRefused };

struct TactileCounters {
  std::uint32_t samples = 0;
  std::uint32_t incomplete = 0;  ///< samples dropped because a frame was missing or mixed up
  std::uint32_t malformed = 0;   ///< frames of wrong size or kind
};

/// Assembles samples of the tactile module from its four frames, calibrates, tares and, where the
/// module does not, filters them. Knows no socket and no clock.
class TactileReceiver {
 public:
  explicit TactileReceiver(const CanTactileConfig& config);

  void receive(const CanFrame& frame) noexcept;

  /// Starts averaging the offset anew. Never in contact: |F| above tare_max_offset_N or unsteady
  /// refuses it.
  void startTare() noexcept;
  TareState tareState() const noexcept;

  /// The newest complete sample, tared and filtered; its sequence counts samples from 1.
  const TactileSample& sample() const noexcept;
  /// kNone, kTactileSaturated or kTactileCableBreak of the newest sample; not latched.
  Fault fault() const noexcept;
  const TactileCounters& counters() const noexcept;
};

}  // namespace tactus
