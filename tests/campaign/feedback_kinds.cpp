#include <algorithm>
#include <cmath>

#include "campaign/injection.h"

namespace tactus::campaign {
namespace {

/// Hash of a time, for what looks like chance.
std::uint32_t noise(int t_ms) {
  std::uint32_t x = static_cast<std::uint32_t>(t_ms) * 2654435761U;
  x ^= x >> 15;
  return x * 2246822519U >> 8;
}

void keepWord(Injection& x, int bus, CanFrame& frame) {
  if (!x.isFeedback(bus, frame)) return;
  if (!x.has_kept[0]) x.kept[0] = frame;
  x.has_kept[0] = true;
  std::copy_n(x.kept[0].data.begin(), 2, frame.data.begin());
}

void keepPosition(Injection& x, int bus, CanFrame& frame) {
  if (!x.isFeedback(bus, frame)) return;
  if (!x.has_kept[0]) x.kept[0] = frame;
  x.has_kept[0] = true;
  std::copy_n(x.kept[0].data.begin() + 2, 4, frame.data.begin() + 2);
}

void hearFrame(Injection& x, VirtualRobotCell& cell, const CanFrame& frame) {
  cell.cycle.receive(x.bus, {&frame, 1});
}

const InjectionKind kKindsFeedback[] = {
    {.name = "drive_silent",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 10,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (bus == x.bus && (f.id & 0x7F) == x.node) f.id = kNobody;
         }},
    {.name = "feedback_lost",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 10,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.id = kNobody;
         }},
    {.name = "heartbeat_lost",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 90,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isHeartbeat(bus, f)) f.id = kNobody;
         }},
    {.name = "fault_shown",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 4,
     .lets_go = true,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.data[0] = 0x08;
         }},
    {.name = "off_shown",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 4,
     .lets_go = true,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.data[0] = 0x40;
         }},
    {.name = "switched_on_shown",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 4,
     .lets_go = true,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.data[0] = 0x33;
         }},
    {.name = "enabled_shown",
     .where = InjectionKind::Where::kDrive,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.data[0] = 0x37;
         }},
    {.name = "status_unknown",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 4,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.data[0] = 0x67;
         }},
    {.name = "status_nonsense",
     .where = InjectionKind::Where::kDrive,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) writeLittleEndian(f, 0, 2, noise(x.t_ms) & 0xFFFF);
         }},
    {.name = "status_frozen", .where = InjectionKind::Where::kDrive, .receive = keepWord},
    {.name = "position_frozen", .where = InjectionKind::Where::kDrive, .receive = keepPosition},
    {.name = "position_jump",
     .where = InjectionKind::Where::kDrive,
     .low = 0.06,
     .high = 1.0,
     .receive = [](Injection& x, int bus, CanFrame& f) { shiftPosition(x, bus, f, x.size); }},
    {.name = "position_drift",
     .where = InjectionKind::Where::kDrive,
     .low = 0.01,
     .high = 0.5,
     .receive = [](Injection& x, int bus,
                   CanFrame& f) { shiftPosition(x, bus, f, 1e-3 * x.t_ms * x.size); }},
    {.name = "frozen_altogether",
     .where = InjectionKind::Where::kDrive,
     .receive = [](Injection& x, int bus,
                   CanFrame& f) { keepWord(x, bus, f), keepPosition(x, bus, f); }},
    {.name = "emergency_message",
     .where = InjectionKind::Where::kDrive,
     .act =
         [](Injection& x, VirtualRobotCell& cell) {
           if (x.t_ms == 0)
             hearFrame(x, cell, emergencyFrame(static_cast<int>(x.node), {0x2310, 1}));
         }},
    {.name = "boot_up_message",
     .where = InjectionKind::Where::kDrive,
     .lets_go = true,
     .act =
         [](Injection& x, VirtualRobotCell& cell) {
           const bool is_due = x.t_ms % (40 * x.period_ms) == 0;
           if (is_due)
             hearFrame(x, cell, heartbeatFrame(static_cast<int>(x.node), NmtState::kBootUp));
         }},
};

}  // namespace

std::span<const InjectionKind> feedbackKinds() { return kKindsFeedback; }

}  // namespace tactus::campaign
