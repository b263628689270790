#pragma once

#include <vector>

#include "tactus/canopen/hardware_config.h"

namespace tactus {

/// Share of the bit rate that a scene may use: the rest is for set-up, emergencies and repeats.
inline constexpr double kMaxBusLoad = 0.8;

/// Bits of a classic frame with 11-bit id and all the stuff bits that n data bytes can need, with
/// the pause behind it.
constexpr int worstCaseBits(int data_bytes) noexcept { return 55 + 10 * data_bytes; }

/// Frames of one kind on a bus.
struct BusLoadTerm {
  const char* name;  ///< as "RPDO1"
  int frames = 0;    ///< each period
  int data_bytes = 0;
  double period_s = 0.0;

  double bitsPerSecond() const noexcept { return frames * worstCaseBits(data_bytes) / period_s; }
};

/// Worst-case load of a bus in operation, as a sum whose terms can be printed.
struct BusLoad {
  std::vector<BusLoadTerm> terms;
  double bit_rate_per_s = 0.0;

  double bitsPerSecond() const noexcept;
  double share() const noexcept { return bitsPerSecond() / bit_rate_per_s; }
};

/// One for each bus of the configuration. period_s: of the control cycle.
std::vector<BusLoad> busLoads(const HardwareConfig& hardware, double period_s);

}  // namespace tactus
