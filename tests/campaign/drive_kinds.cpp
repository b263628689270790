#include <algorithm>
#include <cmath>

#include "campaign/injection.h"

namespace tactus::campaign {
namespace {

constexpr int kPush_ms = 100;

bool losesCommands(Injection& x, int bus, CanFrame& frame) {
  return bus != x.bus || (frame.id != 0x200 + x.node && frame.id != 0x600 + x.node);
}

void sendSdo(Injection& x, VirtualRobotCell& cell, std::uint8_t command, std::uint16_t index,
             std::uint8_t subindex, std::uint32_t value) {
  CanFrame frame;
  frame.id = 0x600 + x.node;
  frame.size = 8;
  frame.data = {command, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8),
                subindex};
  writeLittleEndian(frame, 4, 4, value);
  cell.plant.send(x.bus, frame, cell.t_ns);
}

template <NmtCommand command>
void commandNode(Injection& x, VirtualRobotCell& cell) {
  if (x.t_ms == 0) cell.plant.send(x.bus, nmtFrame({command, static_cast<int>(x.node)}), cell.t_ns);
}

/// Writes to the drive, as somebody else's tool would, that SYNC is not to be watched.
void endSyncWatch(Injection& x, VirtualRobotCell& cell) {
  if (x.t_ms == 0) sendSdo(x, cell, 0x2F, 0x60C2, 1, 255);
  if (x.t_ms == 2) sendSdo(x, cell, 0x2F, 0x60C2, 2, 0);
}

/// A drive that does not stop by itself when its communication is reset, and has the factory's
/// settings then: no heartbeat is watched any more.
void outliveReset(Injection& x, VirtualRobotCell& cell) {
  endSyncWatch(x, cell);
  if (!x.has_kept[0]) return;
  x.has_kept[0] = false;
  const auto command = static_cast<NmtCommand>(x.kept[0].data[0]);
  for (int node = 1; node <= 3; ++node) {
    if (node == static_cast<int>(x.node))
      sendSdo(x, cell, 0x23, 0x1016, 1, 0);
    else if (x.kept[0].data[1] == 0)
      cell.plant.send(x.bus, nmtFrame({command, node}), cell.t_ns);
  }
}

bool losesAllButHeartbeat(Injection& x, int bus, CanFrame& frame) {
  const bool concerns = frame.data[1] == 0 || frame.data[1] == x.node;
  if (bus != x.bus || frame.id != 0 || frame.data[0] < 128 || !concerns)
    return losesCommands(x, bus, frame);
  x.kept[0] = frame;
  x.has_kept[0] = true;
  return false;
}

/// Moved by somebody, once it has been without torque for a while; put back when the time is over.
void pushLimpJoint(Injection& x, VirtualRobotCell& cell) {
  const PowerState state = cell.plant.drive(x.joint).powerState();
  const bool is_limp = state != PowerState::kOperationEnabled &&
                       state != PowerState::kQuickStopActive &&
                       state != PowerState::kFaultReactionActive;
  x.limp_ms = is_limp ? x.limp_ms + 1 : 0;
  if (x.limp_ms < 50) return;
  const double goal = x.t_ms < x.until_ms - x.from_ms ? x.size : 0.0;
  const double step = std::abs(x.size) / kPush_ms;
  x.offset = std::clamp(goal, x.offset - step, x.offset + step);
}

const InjectionKind kKindsDrive[] = {
    {.name = "drive_fault",
     .where = InjectionKind::Where::kDrive,
     .detected_ms = 6,
     .script = Trouble::Kind::kDriveFault},
    {.name = "drive_leaves_operation",
     .where = InjectionKind::Where::kDrive,
     .lets_go = true,
     .act =
         [](Injection& x, VirtualRobotCell& cell) {
           if (x.t_ms == 0) sendSdo(x, cell, 0x2B, 0x6040, 0, 0);
         }},
    {.name = "node_reset",
     .where = InjectionKind::Where::kDrive,
     .lets_go = true,
     .act = commandNode<NmtCommand::kResetNode>},
    {.name = "communication_reset",
     .where = InjectionKind::Where::kDrive,
     .lets_go = true,
     .act = commandNode<NmtCommand::kResetCommunication>},
    {.name = "node_stopped",
     .where = InjectionKind::Where::kDrive,
     .act = commandNode<NmtCommand::kStop>},
    {.name = "node_preoperational",
     .where = InjectionKind::Where::kDrive,
     .act = commandNode<NmtCommand::kEnterPreOperational>},
    {.name = "setpoints_lost",
     .where = InjectionKind::Where::kDrive,
     .send = [](Injection& x, int bus, CanFrame& f) { return !x.isSetpoint(bus, f); }},
    {.name = "commands_ignored", .where = InjectionKind::Where::kDrive, .send = losesCommands},
    {.name = "velocity_kept",
     .where = InjectionKind::Where::kDrive,
     .lets_go = true,
     .send =
         [](Injection& x, int bus, CanFrame& f) {
           if (!x.isSetpoint(bus, f)) return true;
           if (!x.has_kept[0]) x.kept[0] = f;
           x.has_kept[0] = true;
           std::copy_n(x.kept[0].data.begin() + 2, 4, f.data.begin() + 2);
           return true;
         }},
    {.name = "control_word_kept",
     .where = InjectionKind::Where::kDrive,
     .send =
         [](Injection& x, int bus, CanFrame& f) {
           if (!x.isSetpoint(bus, f)) return true;
           if (!x.has_kept[0]) x.kept[0] = f;
           x.has_kept[0] = true;
           std::copy_n(x.kept[0].data.begin(), 2, f.data.begin());
           return true;
         }},
    {.name = "runaway",
     .where = InjectionKind::Where::kDrive,
     .lets_go = true,
     .low = 0.02,
     .high = 0.3,
     .send =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isSetpoint(bus, f)) setNumber(f, x.size * x.counts_per_unit);
           return true;
         }},
    {.name = "deaf",
     .where = InjectionKind::Where::kDrive,  // stops as without SYNC, and sends nothing at one
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (x.isFeedback(bus, f)) f.id = kNobody;
         },
     .send = losesCommands,
     .act =
         [](Injection& x, VirtualRobotCell& cell) {
           const NmtMessage stop{NmtCommand::kEnterPreOperational, static_cast<int>(x.node)};
           if (x.t_ms == 5) cell.plant.send(x.bus, nmtFrame(stop), cell.t_ns);
         }},
    {.name = "no_sync_watch",
     .where = InjectionKind::Where::kDrive,
     .send = losesCommands,
     .act = endSyncWatch},
    {.name = "heartbeat_watch_only",
     .where = InjectionKind::Where::kDrive,
     .send = losesAllButHeartbeat,
     .act = outliveReset},
    {.name = "pushed",
     .where = InjectionKind::Where::kDrive,
     .lasts = true,
     .low = 0.05,
     .high = 0.3,
     .receive = [](Injection& x, int bus, CanFrame& f) { shiftPosition(x, bus, f, x.offset); },
     .act = pushLimpJoint},
};

}  // namespace

std::span<const InjectionKind> driveKinds() { return kKindsDrive; }

}  // namespace tactus::campaign
