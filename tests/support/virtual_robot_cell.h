#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tactus/daemon/control_cycle.h"
#include "tactus/daemon/scene.h"
#include "tactus/io/bus_monitor.h"
#include "tactus/plant/plant.h"

namespace tactus::test {

/// The daemon's cycle and the plant on buses of bit time, in virtual time: all but sockets, lines
/// and the clock.
class VirtualRobotCell {
 public:
  explicit VirtualRobotCell(const Scene& scene)
      : cycle(scene),
        plant(scene.controller, scene.plant, *scene.hardware, scene.period_s, scene.troubles),
        monitors(scene.hardware->buses.size()),
        period_ns_(std::llround(1e9 * scene.period_s)) {}

  /// One period; the frames of the daemon go out this much after it woke.
  void step(std::int64_t send_after_ns = 100'000) {
    plant.advance(t_ns);
    exchangeInput();
    input.lines.emergency_stop |= plant.emergencyStop(t_ns);
    cycle.update(input);
    sendOutput(t_ns + send_after_ns);
    t_ns += period_ns_;
    ++cycles;
  }

  bool runUntil(Mode mode, int max_cycles) {
    for (int i = 0; i < max_cycles && cycle.report().mode != mode; ++i) step();
    return cycle.report().mode == mode;
  }

  ControlCycle cycle;
  Plant plant;
  std::vector<BusMonitor> monitors;
  CycleInput input;
  std::int64_t t_ns = 0;
  long long cycles = 0;

 private:
  void exchangeInput() {
    for (std::size_t bus = 0; bus < monitors.size(); ++bus) {
      FrameBatch frames, data;
      plant.take(static_cast<int>(bus), frames);
      for (const CanFrame& frame : frames) {
        if (frame.kind == FrameKind::kError) {
          monitors[bus].onErrorFrame(frame);
        } else {
          data.push(frame);
        }
      }
      monitors[bus].onReceived(static_cast<int>(data.size()), false);
      monitors[bus].update();
      input.bus_faults[bus] = monitors[bus].fault();
      cycle.receive(static_cast<int>(bus), data.frames());
    }
  }

  /// As on vcan: what is handed over is confirmed at once.
  void sendOutput(std::int64_t at_ns) {
    for (std::size_t bus = 0; bus < monitors.size(); ++bus) {
      const FrameBatch& outbox = cycle.outbox(static_cast<int>(bus));
      if (outbox.empty() || !monitors[bus].maySend()) continue;
      const int count = static_cast<int>(outbox.size());
      for (const CanFrame& frame : outbox) plant.send(static_cast<int>(bus), frame, at_ns);
      monitors[bus].onSent(count, count);
      monitors[bus].onConfirmed(count);
    }
  }

  std::int64_t period_ns_;
};

}  // namespace tactus::test
