#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/drive_setup.h"

namespace tactus {
namespace {

using Kind = SetupStep::Kind;
using Need = SetupStep::Need;

/// COB-id of a TPDO: no remote frames (CiA 301, 7.5.2.37, bit 30).
constexpr std::uint32_t kNoRemote = 0x40000000;
constexpr std::uint32_t kEverySync = 1;  // transmission type
/// Unit of velocities: increments (0xB5) a second (0x03), without a power of ten before them.
constexpr std::uint32_t kCountsPerSecond = 0x00B50300;
constexpr std::uint32_t kUnitBits = 0xFFFFFF00;

SetupStep write(std::uint16_t index, std::uint8_t subindex, int size, std::uint32_t value) {
  return {Kind::kWrite, {index, subindex, size}, value};
}

SetupStep ensure(std::uint16_t index, std::uint8_t subindex, int size, std::uint32_t value) {
  return {Kind::kEnsure, {index, subindex, size}, value};
}

/// COB-id of a PDO, bit 31: not valid (CiA 301, 7.5.2.35).
SetupStep stopPdo(std::uint16_t index) {
  constexpr std::uint32_t kNotValid = 0x80000000;
  return {Kind::kEnsure, {index, 1, 4}, kNotValid, kNotValid};
}

SetupStep expect(const ObjectEntry& entry, std::uint32_t value, std::uint32_t mask) {
  return {Kind::kExpect, entry, value, mask};
}

SetupStep only(Need need, SetupStep step) {
  step.need = need;
  return step;
}

SetupStep ifThere(const SetupStep& step) { return only(Need::kIfThere, step); }
SetupStep ifWritable(const SetupStep& step) { return only(Need::kIfWritable, step); }

std::uint32_t milliseconds(double duration_s, const char* key) {
  const double ms = std::round(duration_s * 1e3);
  if (ms >= 1.0 && ms <= 65535.0) return static_cast<std::uint32_t>(ms);
  throw std::invalid_argument(std::string(key) + ": drives count heartbeats in whole ms, from " +
                              "0.001 to 65.535 s; choose a time in that range");
}

InterpolationPeriod representablePeriod(double period_s) {
  const auto period = interpolationPeriod(period_s);
  if (!period)
    throw std::invalid_argument(
        "period: drives cannot be told it (object 60C2 holds 1 to 255 times a power of ten of "
        "seconds); choose one as 0.001 or 0.00125 s");
  return *period;
}

/// Counts/s that 60FF never exceeds: VelocityCounts carries at most a half over. A tenth more, as
/// drives may keep it in whole turns a minute: one that is slower than the joint falls behind.
std::uint32_t speedLimit(const DriveConfig& drive) {
  constexpr double kSlack = 1.1;
  return static_cast<std::uint32_t>(kSlack * drive.max_velocity * drive.counts_per_unit) + 1;
}

/// A drive of CiA 402, and the one that was meant.
SetupSteps identitySteps(const DriveConfig& drive) {
  constexpr std::uint32_t kAllBits = 0xFFFFFFFF;
  SetupSteps steps{expect({0x1000, 0, 4}, 402, 0xFFFF)};
  if (drive.vendor_id) steps.push_back(expect({0x1018, 1, 4}, *drive.vendor_id, kAllBits));
  if (drive.product_code) steps.push_back(expect({0x1018, 2, 4}, *drive.product_code, kAllBits));
  return steps;
}

}  // namespace

/// In milliseconds where they are whole: there are drives that know no other unit.
std::optional<InterpolationPeriod> interpolationPeriod(double period_s) noexcept {
  for (const int exponent : {-3, 0, -1, -2, -4, -5, -6, -7, -8, -9}) {
    const double value = period_s * std::pow(10.0, -exponent);
    const double whole = std::round(value);
    if (whole >= 1.0 && whole <= 255.0 && std::abs(value - whole) < 1e-6)
      return InterpolationPeriod{static_cast<std::uint8_t>(whole),
                                 static_cast<std::int8_t>(exponent)};
  }
  return std::nullopt;
}

SetupSteps setupSteps(const DriveConfig& drive, const CanopenConfig& canopen, double period_s) {
  const auto node = static_cast<std::uint32_t>(drive.node_id);
  const auto master = static_cast<std::uint32_t>(canopen.master_node_id);
  const std::uint32_t heartbeat_ms = milliseconds(canopen.heartbeat_period_s, "heartbeat_period_s");
  const std::uint32_t timeout_ms = milliseconds(canopen.heartbeat_timeout_s, "heartbeat_timeout_s");
  const InterpolationPeriod period = representablePeriod(period_s);
  SetupSteps steps = identitySteps(drive);
  const auto add = [&steps](std::initializer_list<SetupStep> more) {
    steps.insert(steps.end(), more);
  };
  add({
      write(0x6040, 0, 2, 0x0002),  // may still be moving for a master that has gone
      // Mapping is changed while the PDO is not valid and its number of entries is 0
      // (CiA 301, 7.5.2.36, 7.5.2.38).
      stopPdo(0x1400),
      write(0x1600, 0, 1, 0),
      write(0x1600, 1, 4, 0x60400010),
      write(0x1600, 2, 4, 0x60FF0020),
      write(0x1600, 0, 1, 2),
      write(0x1400, 2, 1, kEverySync),
      // Deadline of setpoints (CiA 301, 7.5.2.35, event timer): SYNC and heartbeat may still come
      // when they do not.
      ifWritable(write(0x1400, 5, 2, timeout_ms)),
      stopPdo(0x1800),
      write(0x1A00, 0, 1, 0),
      write(0x1A00, 1, 4, 0x60410010),
      write(0x1A00, 2, 4, 0x60640020),
      write(0x1A00, 0, 1, 2),
      write(0x1800, 2, 1, kEverySync),
  });
  // By default a drive may obey what comes in these, too (CiA 301, 7.3.5: 0x300 to 0x500 + node id
  // by RPDOs 2 to 4, those above are off). One that cannot be switched off is no worse than before.
  for (std::uint16_t index = 0x1401; index <= 0x1403; ++index)
    steps.push_back(ifWritable(stopPdo(index)));
  // What else it may send by default would not be in the bus's calculated load.
  for (int pdo = 1; pdo < drive.transmit_pdos; ++pdo)
    steps.push_back(ifThere(stopPdo(static_cast<std::uint16_t>(0x1800 + pdo))));
  add({
      write(0x1400, 1, 4, cob_id::kRpdo1 + node),
      write(0x1800, 1, 4, kNoRemote | (cob_id::kTpdo1 + node)),
      write(0x6060, 0, 1, 9),           // cyclic synchronous velocity
      expect({0x6061, 0, 1}, 9, 0xFF),  // some drives show it only after a while
      // Offsets that a master before has left would be added to each velocity and torque.
      ifThere(ensure(0x60B1, 0, 4, 0)),
      ifThere(ensure(0x60B2, 0, 2, 0)),
      // There are drives of one period, or of one unit for it, that cannot be written.
      ensure(0x60C2, 1, 1, period.value),
      ensure(0x60C2, 2, 1, static_cast<std::uint8_t>(period.exponent)),
  });
  // Drives that know units mostly come with turns a minute, and so fast 60FF would be.
  if (drive.has_velocity_unit) add({ifThere(expect({0x60A9, 0, 4}, kCountsPerSecond, kUnitBits))});
  // Max profile velocity: a drive that heeds it here does not follow what on its way to it became
  // faster than the joint may be. One that knows less, or limits itself further, is no worse.
  if (drive.has_speed_limit && std::isfinite(drive.max_velocity))
    steps.push_back(only(Need::kIfTaken, write(0x607F, 0, 4, speedLimit(drive))));
  // Quick stop: its own ramp, then disabled.
  if (drive.has_quick_stop_option) add({write(0x605A, 0, 2, 2)});
  add({
      ifThere(write(0x605E, 0, 2, 2)),  // fault: slow down on the quick stop's ramp
      ifThere(write(0x6007, 0, 2, 3)),  // master silent: quick stop
      write(0x1016, 1, 4, master << 16 | timeout_ms),
      write(0x1017, 0, 2, heartbeat_ms),
  });
  return steps;
}

}  // namespace tactus
