#include "tactus/daemon/measured_start.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tactus/daemon/bus_port.h"
#include "tactus/daemon/stop_signals.h"
#include "tactus/record/fault_text.h"
#include "tactus/record/run_error.h"
#include "tactus/rt/periodic_timer.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/yaml_tree.h"
#include "tactus/supervisor/joint_reader.h"

namespace tactus {
namespace {

std::vector<std::unique_ptr<BusPort>> openOrRefuse(const HardwareConfig& hardware,
                                                   double period_s) {
  try {
    return openBuses(hardware, period_s);
  } catch (const std::runtime_error& error) {
    throw RunError(error.what());
  }
}

/// Of a stop signal that waits for the drives to be let go.
bool isStopped() noexcept {
  sigset_t pending;
  sigemptyset(&pending);
  sigpending(&pending);
  return std::ranges::any_of(kStopSignals, [&](int it) { return sigismember(&pending, it) == 1; });
}

void exchange(std::vector<std::unique_ptr<BusPort>>& buses, JointReader& reader, bool is_stopped) {
  std::array<Fault, kMaxBuses> faults{};
  for (std::size_t i = 0; i < buses.size(); ++i) {
    faults[i] = buses[i]->receive();
    reader.receive(static_cast<int>(i), buses[i]->frames.frames());
  }
  if (is_stopped)
    reader.leave();
  else
    reader.update(std::span(faults).first(buses.size()));
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const int bus = static_cast<int>(i);
    if (!buses[i]->send(reader.outbox(bus), reader.probe())) reader.noteHeldBack(bus);
  }
}

}  // namespace

void checkMeasuredStart(const Scene& scene) {
  if (!startsMeasured(scene) || hasEnableLine(scene)) return;
  failAt(locate(*scene.tree, "task.commands.start_measured"), "task.commands.start_measured",
         "no enable line: a restart would move the arm from anywhere",
         "expected gpio.enable in the robot's file");
}

JointVector readJoints(const Scene& scene) {
  const HardwareConfig& hardware = *scene.hardware;
  const HeldSignals held;
  auto buses = openOrRefuse(hardware, scene.period_s);
  JointReader reader(hardware, scene.period_s);
  PeriodicTimer timer(std::llround(1e9 * scene.period_s));
  while (!reader.isDone()) {
    timer.wait();
    const bool is_stopped = isStopped();
    exchange(buses, reader, is_stopped);
    if (is_stopped) throw RunError("stopped while the drives were read");
  }
  if (reader.report().fault != Fault::kNone) throw RunError(faultEvent(reader.report(), scene));
  return reader.q();
}

JointVector startAt(const Scene& scene, const JointVector& q) {
  const JointLimits& limits = scene.controller.limits;
  const JointVector within = q.cwiseMax(limits.lower).cwiseMin(limits.upper);
  const auto is_beside = (q - within).cwiseAbs().array() <= scene.hardware->start_tolerance;
  return is_beside.select(within, q);
}

std::string startText(const JointVector& q) {
  std::vector<std::string> numbers;
  for (const double position : q) numbers.push_back(fmt::format("{}", position));
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

}  // namespace tactus
