#include "campaign/injection.h"

namespace tactus::campaign {
namespace {

constexpr int kNetworkDown = 100;  // ENETDOWN

CanFrame errorFrame(std::uint32_t error_class, std::uint8_t controller_state = 0) {
  CanFrame frame;
  frame.kind = FrameKind::kError;
  frame.id = error_class;
  frame.size = 8;
  frame.data[1] = controller_state;
  return frame;
}

const InjectionKind kKindsBus[] = {
    {.name = "bus_stalled",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 8,
     .monitor = [](Injection&, BusMonitor& m) { m.onSent(0, 4); }},
    {.name = "bus_unacknowledged",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 2,
     .monitor = [](Injection&, BusMonitor& m) { m.onErrorFrame(errorFrame(0x24, 0x20)); }},
    {.name = "bus_off_reported",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 2,
     .monitor = [](Injection&, BusMonitor& m) { m.onErrorFrame(errorFrame(0x40)); }},
    {.name = "bus_down",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 2,
     .monitor = [](Injection&, BusMonitor& m) { m.onReceiveError(kNetworkDown); }},
    {.name = "bus_flooded",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 4,
     .monitor =
         [](Injection&, BusMonitor& m) {
           for (int i = 0; i < 3; ++i) m.onReceived(64, true);
         }},
    {.name = "sync_lost",
     .where = InjectionKind::Where::kBus,
     .send = [](Injection& x, int bus, CanFrame& f) { return bus != x.bus || f.id != 0x80; }},
    {.name = "master_heartbeat_lost",
     .where = InjectionKind::Where::kBus,
     .send = [](Injection& x, int bus, CanFrame& f) { return bus != x.bus || f.id != 0x77F; }},
    {.name = "bus_off",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 8,
     .script = Trouble::Kind::kBusOff},
    {.name = "power_cut",
     .where = InjectionKind::Where::kBus,
     .detected_ms = 40,
     .script = Trouble::Kind::kPowerCut},
    {.name = "frames_dropped", .where = InjectionKind::Where::kBus, .script = Trouble::Kind::kDrop},
    {.name = "frames_late",
     .where = InjectionKind::Where::kBus,
     .low = 0.0003,
     .high = 0.03,
     .script = Trouble::Kind::kDelay},
    {.name = "frames_swapped",
     .where = InjectionKind::Where::kBus,
     .script = Trouble::Kind::kReorder},
    {.name = "frames_corrupted",
     .where = InjectionKind::Where::kBus,
     .lets_go = true,
     .script = Trouble::Kind::kCorrupt},
    {.name = "frames_doubled",
     .where = InjectionKind::Where::kBus,
     .script = Trouble::Kind::kDuplicate},
};

}  // namespace

std::span<const InjectionKind> busKinds() { return kKindsBus; }

}  // namespace tactus::campaign
