#include "tactus/daemon/bus_port.h"

#include "tactus/canopen/can_robot.h"
#include "tactus/io/bus_ids.h"

namespace tactus {
namespace {

CanSocket openSocket(const HardwareConfig& hardware, int bus) {
  const BusIds ids = busIds(hardware, bus);
  return CanSocket(hardware.buses[bus].interface, ids.received, ids.sent,
                   hardware.buses[bus].data_bit_rate_per_s.has_value());
}

}  // namespace

BusPort::BusPort(const HardwareConfig& hardware, int bus, double period_s)
    : lock(hardware.buses[bus].interface), socket(openSocket(hardware, bus)) {
  socket.monitor() = BusMonitor(probeCycles(hardware.canopen, period_s));
}

Fault BusPort::receive() noexcept {
  socket.receive(frames);
  socket.monitor().update();
  return socket.monitor().fault();
}

bool BusPort::send(const FrameBatch& outbox, const CanFrame& probe) noexcept {
  const bool is_sent = socket.send(outbox.frames());
  socket.probe(probe);
  return is_sent;
}

std::vector<std::unique_ptr<BusPort>> openBuses(const HardwareConfig& hardware, double period_s) {
  std::vector<std::unique_ptr<BusPort>> buses;
  for (std::size_t bus = 0; bus < hardware.buses.size(); ++bus)
    buses.push_back(std::make_unique<BusPort>(hardware, static_cast<int>(bus), period_s));
  return buses;
}

}  // namespace tactus
