#include <algorithm>
#include <cmath>

#include "campaign/injection.h"
#include "tactus/plant/module_frames.h"

namespace tactus::campaign {
namespace {

constexpr int kTactileBus = 3;
constexpr double kCountsPerNewton = 1e5;
constexpr int kHandRise_ms = 50;

bool isTactile(int bus, const CanFrame& frame) { return bus == kTactileBus && frame.id < 0x104; }

/// Signed 24 bits in bytes 2..4: the first of a frame's two channels.
std::int32_t channel(const CanFrame& frame) {
  const std::uint32_t bits = frame.data[2] | frame.data[3] << 8 | frame.data[4] << 16;
  return static_cast<std::int32_t>(bits ^ 0x800000U) - 0x800000;
}

void setChannel(CanFrame& frame, std::int32_t counts) {
  for (int i = 0; i < 3; ++i) frame.data[2 + i] = static_cast<std::uint8_t>(counts >> (8 * i));
}

/// Half of the force at either end of the cover; even nodes: along y, odd ones: along z.
void pressOnCover(Injection& x, int bus, CanFrame& frame) {
  const bool is_along_y = x.node % 2 == 0;
  const std::uint32_t first = is_along_y ? 0x100 : 0x101;
  if (bus != kTactileBus || (frame.id != first && frame.id != first + 2)) return;
  const int left_ms = x.until_ms - x.from_ms - x.t_ms;
  const double share = std::clamp(std::min(x.t_ms, left_ms) / double{kHandRise_ms}, 0.0, 1.0);
  if (std::abs(channel(frame)) >= kModuleFullScale) return;  // stays saturated
  const double counts = channel(frame) + 0.5 * share * x.size * kCountsPerNewton;
  setChannel(frame, static_cast<std::int32_t>(std::clamp(counts, -8e6, 8e6)));
}

void patOnCover(Injection& x, int bus, CanFrame& frame) {
  if (x.t_ms / (20 * x.period_ms) % 2 == 0) pressOnCover(x, bus, frame);
}

/// The module's frames of one moment, with the numbers of later samples or their own.
void keepSample(Injection& x, int bus, CanFrame& frame, bool is_number_kept) {
  if (!isTactile(bus, frame)) return;
  const std::uint32_t k = frame.id - 0x100;
  if (!x.has_kept[k]) x.kept[k] = frame;
  x.has_kept[k] = true;
  const std::uint8_t number = frame.data[0];
  frame = x.kept[k];
  if (!is_number_kept) frame.data[0] = number;
}

const InjectionKind kKindsTactile[] = {
    {.name = "hand",
     .where = InjectionKind::Where::kTactile,
     .is_followed = true,
     .low = 3.0,
     .high = 25.0,
     .receive = pressOnCover},
    {.name = "patting_hand",
     .where = InjectionKind::Where::kTactile,
     .is_followed = true,
     .low = 3.0,
     .high = 25.0,
     .receive = patOnCover},
    {.name = "tactile_silent",
     .where = InjectionKind::Where::kTactile,
     .detected_ms = 32,
     .receive =
         [](Injection&, int bus, CanFrame& f) {
           if (isTactile(bus, f)) f.id = kNobody;
         }},
    {.name = "tactile_stuck",
     .where = InjectionKind::Where::kTactile,
     .detected_ms = 32,
     .receive = [](Injection& x, int bus, CanFrame& f) { keepSample(x, bus, f, true); }},
    {.name = "tactile_constant",
     .where = InjectionKind::Where::kTactile,
     .is_followed = true,
     .receive = [](Injection& x, int bus, CanFrame& f) { keepSample(x, bus, f, false); }},
    {.name = "tactile_saturated",
     .where = InjectionKind::Where::kTactile,
     .detected_ms = 12,
     .receive =
         [](Injection&, int bus, CanFrame& f) {
           if (isTactile(bus, f) && f.id == 0x101) setChannel(f, 0x7FFFFF);
         }},
    {.name = "tactile_cable_break",
     .where = InjectionKind::Where::kTactile,
     .detected_ms = 12,
     .receive =
         [](Injection&, int bus, CanFrame& f) {
           if (isTactile(bus, f)) f.data[1] |= 2;
         }},
    {.name = "tactile_invalid",
     .where = InjectionKind::Where::kTactile,
     .detected_ms = 16,
     .receive =
         [](Injection&, int bus, CanFrame& f) {
           if (isTactile(bus, f) && f.id % 2 == 0) setChannel(f, 8'000'000);
         }},
    {.name = "tactile_frame_missing",
     .where = InjectionKind::Where::kTactile,
     .detected_ms = 32,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (isTactile(bus, f) && f.id == 0x100 + x.node) f.id = kNobody;
         }},
    {.name = "tactile_restarted",
     .where = InjectionKind::Where::kTactile,
     .receive =
         [](Injection& x, int bus, CanFrame& f) {
           if (!isTactile(bus, f)) return;
           if (x.t_ms < 20 * x.period_ms) f.id = kNobody;
           f.data[0] = static_cast<std::uint8_t>(f.data[0] + 101);
         }},
};

}  // namespace

std::span<const InjectionKind> tactileKinds() { return kKindsTactile; }

}  // namespace tactus::campaign
