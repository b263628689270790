#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <vector>

#include "tactus/io/bus_monitor.h"
#include "tactus/plant/plant.h"
#include "tactus/scene/scene.h"
#include "tactus/supervisor/control_cycle.h"

namespace tactus::test {

/// The daemon's cycle and the plant on buses of bit time, in virtual time: all but sockets, lines
/// and the clock.
class VirtualRobotCell {
 public:
  explicit VirtualRobotCell(const Scene& scene)
      : cycle(scene.controller, *scene.hardware, scene.period_s),
        plant(scene.controller, scene.plant, *scene.hardware, scene.period_s, scene.troubles),
        monitors(scene.hardware->buses.size(),
                 BusMonitor(probeCycles(scene.hardware->canopen, scene.period_s))),
        joints_(scene.controller.chain.size()),
        period_ns_(std::llround(1e9 * scene.period_s)) {}

  /// One period.
  void step() {
    exchangeInput();
    cycle.update(input);
    sendOutput();
  }

  /// One period, after as many that the loop missed.
  void pause(int missed) {
    t_ns += missed * period_ns_;
    input.missed_cycles = missed;
    input.late_in_a_row = missed + 1;
    step();
    input.missed_cycles = input.late_in_a_row = 0;
  }

  void exchangeInput() {
    plant.advance(t_ns);
    for (int bus = 0; bus < plant.buses(); ++bus) exchangeInput(bus);
    input.lines.emergency_stop |= plant.emergencyStop(t_ns);
  }

  void sendOutput() {
    for (int bus = 0; bus < plant.buses(); ++bus) sendOutput(bus, t_ns + kSendAfter_ns);
    t_ns += period_ns_;
  }

  static int velocityCounts(const CanFrame& rpdo) {
    std::int32_t counts = 0;
    std::memcpy(&counts, rpdo.data.data() + 2, sizeof(counts));
    return counts;
  }

  bool runUntil(Mode mode, int max_cycles) {
    for (int i = 0; i < max_cycles && cycle.report().mode != mode; ++i) step();
    return cycle.report().mode == mode;
  }

  /// Of the last cycle.
  CycleRecord record() const {
    CycleRecord record;
    cycle.fill(record);
    return record;
  }

  /// Largest velocity that the daemon sends to any drive in this cycle, counts/s.
  int largestSetpoint() const {
    int largest = 0;
    for (std::size_t bus = 0; bus < monitors.size(); ++bus) {
      if (!monitors[bus].maySend()) continue;  // it stays with the daemon
      for (const CanFrame& frame : cycle.outbox(static_cast<int>(bus))) {
        const bool is_setpoint = frame.id > 0x200 && frame.id < 0x280;
        if (is_setpoint) largest = std::max(largest, std::abs(velocityCounts(frame)));
      }
    }
    return largest;
  }

  /// Enable line off and on again.
  void switchEnable() {
    input.lines.enable = false;
    for (int i = 0; i < 50; ++i) step();
    input.lines.enable = true;
  }

  bool isAnyDrive(PowerState state) const {
    for (int joint = 0; joint < joints_; ++joint)
      if (plant.powerState(joint) == state) return true;
    return false;
  }

  /// No drive of the plant has a torque.
  bool areDrivesLimp() const {
    for (int joint = 0; joint < joints_; ++joint)
      if (hasTorque(plant.powerState(joint))) return false;
    return true;
  }

  /// No drive of the plant has power.
  bool areDrivesOff() const { return areDrivesLimp() && !isAnyDrive(PowerState::kSwitchedOn); }

  ControlCycle cycle;
  Plant plant;
  std::function<void(int bus, CanFrame& frame)> on_frame;     ///< may change what the daemon gets
  std::function<void(int bus, FrameBatch& frames)> on_batch;  ///< and in which order
  std::function<bool(int bus, CanFrame& frame)> on_send;      ///< and what it sends; false: lost
  std::function<void(int bus, BusMonitor& monitor)> on_bus;   ///< may add to what a bus meets
  std::vector<BusMonitor> monitors;
  CycleInput input;
  std::int64_t t_ns = 0;

 private:
  static constexpr std::int64_t kSendAfter_ns = 100'000;  ///< after waking

  void exchangeInput(int bus) {
    BusMonitor& monitor = monitors[bus];
    FrameBatch frames, data;
    plant.take(bus, frames);
    for (CanFrame frame : frames) {
      if (on_frame) on_frame(bus, frame);
      if (frame.kind == FrameKind::kError) {
        monitor.onErrorFrame(frame);
      } else {
        data.push(frame);
      }
    }
    if (on_batch) on_batch(bus, data);
    monitor.onReceived(static_cast<int>(data.size()), false);
    if (on_bus) on_bus(bus, monitor);
    monitor.update();
    input.bus_faults[bus] = monitor.fault();
    cycle.receive(bus, data.frames());
  }

  /// As on vcan: what is handed over is confirmed at once.
  void sendOutput(int bus, std::int64_t at_ns) {
    BusMonitor& monitor = monitors[bus];
    const FrameBatch& outbox = cycle.outbox(bus);
    if (monitor.mayProbe()) {
      send(bus, cycle.probe(), at_ns);
      confirm(monitor, 1);
    }
    if (outbox.empty() || !monitor.maySend()) return;
    for (const CanFrame& frame : outbox) send(bus, frame, at_ns);
    confirm(monitor, static_cast<int>(outbox.size()));
  }

  void send(int bus, CanFrame frame, std::int64_t at_ns) {
    if (!on_send || on_send(bus, frame)) plant.send(bus, frame, at_ns);
  }

  static void confirm(BusMonitor& monitor, int frames) {
    monitor.onSent(frames, frames);
    monitor.onConfirmed(frames);
  }

  int joints_;
  std::int64_t period_ns_;
};

}  // namespace tactus::test
