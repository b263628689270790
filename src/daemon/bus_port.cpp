#include "tactus/daemon/bus_port.h"

#include "tactus/io/bus_ids.h"

namespace tactus {
namespace {

CanSocket openSocket(const HardwareConfig& hardware, int bus) {
  const BusIds ids = busIds(hardware, bus);
  return CanSocket(hardware.buses[bus].interface, ids.received, ids.sent,
                   hardware.buses[bus].data_bit_rate_per_s.has_value());
}

}  // namespace

BusPort::BusPort(const HardwareConfig& hardware, int bus)
    : lock(hardware.buses[bus].interface), socket(openSocket(hardware, bus)) {}

Fault BusPort::receive() noexcept {
  socket.receive(frames);
  socket.monitor().update();
  return socket.monitor().fault();
}

void BusPort::send(const FrameBatch& outbox, const CanFrame& probe) noexcept {
  socket.send(outbox.frames());
  socket.probe(probe);
}

std::vector<std::unique_ptr<BusPort>> openBuses(const HardwareConfig& hardware) {
  std::vector<std::unique_ptr<BusPort>> buses;
  for (std::size_t bus = 0; bus < hardware.buses.size(); ++bus)
    buses.push_back(std::make_unique<BusPort>(hardware, static_cast<int>(bus)));
  return buses;
}

}  // namespace tactus
