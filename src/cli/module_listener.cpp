#include "tactus/cli/module_listener.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <thread>

#include "tactus/daemon/run_status.h"
#include "tactus/io/can_socket.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr double kSilence_s = 1.0;
constexpr double kTick_s = 0.01;  ///< of the receiver, which counts them
constexpr int kWait_ms = 20;

std::array<IdFilter, 4> idsOf(std::uint32_t first_id) {
  std::array<IdFilter, 4> ids;
  for (std::uint32_t k = 0; k < ids.size(); ++k) ids[k].id = first_id + k;
  return ids;
}

/// A socket without an interface is always ready, and has nothing.
void waitForFrames(const CanSocket& socket) {
  pollfd polled{socket.descriptor(), POLLIN, 0};
  const bool has_frames = poll(&polled, 1, kWait_ms) > 0 && (polled.revents & POLLIN) != 0;
  if (!has_frames && polled.revents != 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(kWait_ms));
}

[[noreturn]] void failSilent(const ListenedModule& module, const TactileReceiver& receiver) {
  const TactileCounters& counters = receiver.counters();
  throw RunError(
      fmt::format("{}: no sample of the frames {:#05x} to {:#05x} for {} s; {} incomplete, {} "
                  "malformed frames, "
                  "{} repeated; is the module on, and is first_id right?",
                  escaped(module.interface), module.config.first_id, module.config.first_id + 3,
                  kSilence_s, counters.incomplete, counters.malformed, counters.repeated));
}

}  // namespace

FrameSource framesOf(const std::string& interface, std::uint32_t first_id) {
  const auto ids = idsOf(first_id);
  const auto socket = std::make_shared<CanSocket>(interface, ids, std::span<const IdFilter>());
  const auto forget = [socket] {
    FrameBatch frames;
    // As many as its buffer may hold, for frames go on coming.
    for (int batch = 0; batch < 64; ++batch) {
      socket->receive(frames);
      if (frames.empty()) return;
    }
  };
  const auto next = [socket](FrameBatch& frames) {
    waitForFrames(*socket);
    socket->receive(frames);
    return monotonicTime_s();
  };
  return {forget, next};
}

ChannelWindow listen(const FrameSource& source, const ListenedModule& module, double duration_s) {
  TactileReceiver receiver(module.config, kTick_s);
  ChannelWindow window;
  FrameBatch frames;
  source.forget();
  const double start_s = source.next(frames);  // may be of before
  double now_s = start_s, heard_s = start_s, ticked_s = start_s;
  while (now_s - start_s < duration_s) {
    now_s = source.next(frames);
    for (const CanFrame& frame : frames) {
      const std::uint32_t before = receiver.counters().samples;
      receiver.receive(frame);
      if (receiver.counters().samples == before) continue;
      if (receiver.fault() == Fault::kTactileCableBreak)
        throw RunError(escaped(module.interface) + ": the module says that a cable is broken");
      window.add(receiver.counts(), now_s);
      heard_s = now_s;
    }
    const auto ticks = static_cast<long>((now_s - ticked_s) / kTick_s);
    ticked_s += static_cast<double>(ticks) * kTick_s;
    for (long i = 0; i < ticks; ++i) receiver.tick();
    if (now_s - heard_s > kSilence_s) failSilent(module, receiver);
  }
  if (window.samples() == 0) failSilent(module, receiver);
  return window;
}

}  // namespace tactus
