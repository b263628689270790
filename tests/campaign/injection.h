#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "support/virtual_robot_cell.h"
#include "tactus/canopen/canopen.h"

namespace tactus::campaign {

using test::VirtualRobotCell;

inline constexpr std::uint32_t kNobody = 0x7FF;  ///< id of a frame that is lost

struct Injection;

/// One kind of trouble: what it does, while it is at work, to what passes between daemon and robot.
struct InjectionKind {
  const char* name;
  enum class Where : std::uint8_t { kLines, kTactile, kDrive, kBus } where;
  /// From then on nothing may run: what the fault table promises, and the frame that brings the
  /// news. 0: not to be told, or not in time.
  int detected_ms = 0;
  bool lasts = false;            ///< to the end of the run
  bool lets_go = false;          ///< a drive, or is a reason to take its power at once
  bool is_followed = false;      ///< a force: where it is felt while it runs, the arm gives way
  double low = 0.0, high = 0.0;  ///< of its size, either sign: N, m, rad, m/s or rad/s
  void (*input)(Injection&, CycleInput&) = nullptr;
  int (*missed)(Injection&) = nullptr;                        ///< cycles before this one
  void (*receive)(Injection&, int bus, CanFrame&) = nullptr;  ///< on its way to the daemon
  bool (*send)(Injection&, int bus, CanFrame&) = nullptr;     ///< to the plant; false: lost
  void (*monitor)(Injection&, BusMonitor&) = nullptr;         ///< of its bus
  void (*act)(Injection&, VirtualRobotCell&) = nullptr;       ///< before each cycle
  std::optional<Trouble::Kind> script{};                      ///< the plant's own
};

std::span<const InjectionKind> lineKinds();      ///< lines, the user and the machine
std::span<const InjectionKind> tactileKinds();   ///< the module, and hands on its cover
std::span<const InjectionKind> feedbackKinds();  ///< what a drive says
std::span<const InjectionKind> driveKinds();  ///< what it does and hears, and joints pushed by hand
std::span<const InjectionKind> busKinds();    ///< what the daemon's side meets, and the frames
std::vector<const InjectionKind*> injectionKinds();  ///< all of them
const InjectionKind& kindOf(const char* name);       ///< throws std::invalid_argument
const InjectionKind& hand();                         ///< on the cover
const InjectionKind& push();                         ///< of a joint without torque

/// Times in ms since the run began; one cycle a ms.
struct Injection {
  const InjectionKind* kind = nullptr;
  int from_ms = 0, until_ms = 0;
  int bus = 0, joint = 0;
  std::uint32_t node = 1;
  std::uint32_t id = 0;  ///< of frames; 0: all of the bus
  double size = 0.0;
  int period_ms = 10;
  double counts_per_unit = 1e6;

  int t_ms = 0;                    ///< since from_ms
  std::array<CanFrame, 4> kept{};  ///< the first frames seen
  std::array<bool, 4> has_kept{};
  double offset = 0.0;  ///< of a joint that was pushed, m or rad
  int limp_ms = 0;
  int next_ms = 0;

  bool isAtWork(int now_ms) const {
    return now_ms >= from_ms && (kind->lasts || now_ms < until_ms);
  }
  bool isFeedback(int at, const CanFrame& frame) const {
    return at == bus && frame.id == 0x180 + node;
  }
  bool isSetpoint(int at, const CanFrame& frame) const {
    return at == bus && frame.id == 0x200 + node;
  }
  bool isHeartbeat(int at, const CanFrame& frame) const {
    return at == bus && frame.id == 0x700 + node;
  }
};

/// The position of a feedback frame, or the velocity of a setpoint's, behind the word.
inline void setNumber(CanFrame& frame, double counts) {
  writeLittleEndian(frame, 2, 4, static_cast<std::uint32_t>(static_cast<std::int64_t>(counts)));
}

inline void shiftPosition(Injection& x, int bus, CanFrame& frame, double by) {
  const auto counts = static_cast<std::int32_t>(readLittleEndian(frame, 2, 4));
  if (x.isFeedback(bus, frame)) setNumber(frame, counts + by * x.counts_per_unit);
}

}  // namespace tactus::campaign
