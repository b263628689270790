#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "tactus/canopen/tactile_receiver.h"

namespace {

using tactus::CanFrame;
using tactus::CanTactileConfig;
using tactus::FrameKind;
using tactus::TactileReceiver;

/// Input: one byte of options, then thirteen bytes a frame.
constexpr std::size_t kBytesPerFrame = 13;
/// The cycle's period: one without frames is a silence that makes the receiver forget numbers.
constexpr double kSilence_s = 1.0;

void require(bool holds) {
  if (!holds) std::abort();
}

CanTactileConfig configOf(std::uint8_t options) {
  CanTactileConfig config;
  for (int i = 0; i < 32; ++i) config.channels.calibration(i / 8, i % 8) = 0.25 * (i % 7) - 0.7;
  if ((options & 1) != 0) config.filter_cutoff_hz = 15.0;
  if ((options & 16) != 0) config.channels.moment_x = tactus::TactileChannelRow::Constant(0.3);
  config.tare_samples = 1 + (options >> 1 & 7);
  return config;
}

/// Small ids and kinds are as likely as wild ones, so that samples get complete.
CanFrame frameOf(const std::uint8_t* bytes) {
  CanFrame frame;
  const std::uint8_t head = bytes[0];
  frame.id = 0x100U + (head & 7);
  if ((head & 0xC0) == 0xC0) std::memcpy(&frame.id, bytes + 1, sizeof(frame.id));
  frame.kind = (head & 0x38) == 0x38 ? static_cast<FrameKind>(bytes[1] % 3) : FrameKind::kData;
  frame.extended = (head & 0x38) == 0x30;
  frame.size = (head & 0x38) == 0x28 ? bytes[1] : 8;
  std::memcpy(frame.data.data(), bytes + 5, tactus::kMaxClassicBytes);
  return frame;
}

/// What holds after every frame.
void check(const TactileReceiver& receiver, std::uint64_t frames) {
  const tactus::TactileSample& sample = receiver.sample();
  const tactus::TactileCounters& counters = receiver.counters();
  const double largest = std::max({std::abs(sample.force_y_N), std::abs(sample.force_z_N),
                                   std::abs(sample.moment_y_Nm), std::abs(sample.moment_z_Nm),
                                   std::abs(sample.moment_x_Nm)});
  require(largest < 1e4);  // also refuses NaN
  require(sample.sequence == counters.samples);
  require(4ULL * counters.samples + counters.incomplete + counters.malformed + counters.repeated <=
          frames);
  const tactus::Fault fault = receiver.fault();
  require(fault == tactus::Fault::kNone || fault == tactus::Fault::kTactileSaturated ||
          fault == tactus::Fault::kTactileCableBreak);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  TactileReceiver receiver(configOf(data[0]), kSilence_s);
  std::uint64_t frames = 0;
  for (std::size_t at = 1; at + kBytesPerFrame <= size; at += kBytesPerFrame) {
    if (data[at] == 0xFF) receiver.startTare();
    if (data[at] == 0xFE) receiver.tick();
    const auto samples = receiver.counters().samples;
    receiver.receive(frameOf(data + at));
    check(receiver, ++frames);
    require(receiver.counters().samples - samples <= 1);
  }
  return 0;
}
