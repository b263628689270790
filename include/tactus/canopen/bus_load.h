#pragma once

#include <optional>
#include <vector>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/cycle_count.h"
#include "tactus/canopen/hardware_config.h"

namespace tactus {

/// Share of the bit rate that a scene may use: the rest is for set-up, emergencies and repeats.
inline constexpr double kMaxBusLoad = 0.8;

/// That may come in a cycle, the daemon's own among them, which come back once they are sent: a
/// batch that is full says that more are waiting.
inline constexpr int kMaxFramesACycle = static_cast<int>(FrameBatch::kCapacity) - 1;

/// Bits of a classic frame with 11-bit id and all the stuff bits that n data bytes can need, with
/// the pause behind it.
constexpr int worstCaseBits(int data_bytes) noexcept { return 55 + 10 * data_bytes; }

/// Bits of a CAN FD frame with its rate switched: in arbitration and around it at the bus's bit
/// rate, from behind BRS to the last bit of the CRC at the data bit rate.
struct FdBits {
  int arbitration = 0;
  int data = 0;

  bool operator==(const FdBits&) const = default;
};

/// The same for CAN FD, by the fields of ISO 11898-1:2015, 10.4.2 (as in Linux, can/length.h): n
/// bytes are padded to fdSize(n). Up to BRS there are 17 bits, or 36 with a 29-bit id; then ESI and
/// length, 5, the data, the stuff count, 4, a CRC of 17 bits (up to 16 bytes) or 21, and 6 or 7
/// fixed stuff bits in these; then CRC delimiter, acknowledge, end and pause: 13. Bits before the
/// stuff count are stuffed: one bit more after the first five and then after each four, and as many
/// of them as possible in arbitration, where they take longest.
constexpr FdBits worstCaseFdBits(int data_bytes, bool is_extended) noexcept {
  const int bytes = fdSize(data_bytes);
  const int before = is_extended ? 36 : 17;
  const int between = 5 + 8 * bytes;
  const int stuff_before = (before - 1) / 4;
  const int stuff = (before + between - 1) / 4;
  const int crc = bytes <= 16 ? 17 + 6 : 21 + 7;
  return {before + stuff_before + 13, between + stuff - stuff_before + 4 + crc};
}

/// Frames of CAN FD: how much longer a bit is in arbitration than in the data.
struct FdTiming {
  double rate_ratio = 1.0;  ///< data bit rate over bit rate
  bool is_extended = false;
};

/// Frames of one kind on a bus.
struct BusLoadTerm {
  const char* name;  ///< as "RPDO1"
  int frames = 0;    ///< each period
  int data_bytes = 0;
  double period_s = 0.0;
  std::optional<FdTiming> fd{};  ///< absent: classic frames

  /// In bits at the bus's bit rate.
  double bitsAFrame() const noexcept {
    if (!fd) return worstCaseBits(data_bytes);
    const FdBits bits = worstCaseFdBits(data_bytes, fd->is_extended);
    return bits.arbitration + bits.data / fd->rate_ratio;
  }
  double bitsPerSecond() const noexcept { return frames * bitsAFrame() / period_s; }
  /// At worst, in a cycle.
  int framesACycle(double cycle_s) const noexcept {
    return frames * cyclesLasting(cycle_s, period_s);
  }
};

/// Worst-case load of a bus in operation, as a sum whose terms can be printed.
struct BusLoad {
  std::vector<BusLoadTerm> terms;
  double bit_rate_per_s = 0.0;

  double bitsPerSecond() const noexcept;
  int framesACycle(double cycle_s) const noexcept;
  double share() const noexcept { return bitsPerSecond() / bit_rate_per_s; }
};

/// One for each bus of the configuration. period_s: of the control cycle.
std::vector<BusLoad> busLoads(const HardwareConfig& hardware, double period_s);

}  // namespace tactus
