#include "campaign/plan.h"

#include <fmt/format.h>

#include <algorithm>

namespace tactus::campaign {
namespace {

using test::Random;
using Where = InjectionKind::Where;

constexpr int kForever_ms = 1'000'000;

/// SplitMix64's step, so that neighbouring runs have nothing in common.
std::uint64_t mixed(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15U + index + 0x632BE59BD9B4E019U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

const InjectionKind& drawKind(Random& random) {
  if (random.chance(0.15)) return hand();
  if (random.chance(0.08)) return push();
  static const std::vector<const InjectionKind*> kinds = injectionKinds();
  return *kinds[static_cast<std::size_t>(random.index(static_cast<int>(kinds.size())))];
}

int drawDuration_ms(Random& random, const InjectionKind& kind) {
  const bool is_hand = kind.where == Where::kTactile && kind.high > 0.0;
  return static_cast<int>(is_hand ? random.logUniform(200.0, 25000.0)
                                  : random.logUniform(5.0, 5000.0));
}

void aim(Random& random, const Scene& scene, Injection& x) {
  const HardwareConfig& hardware = *scene.hardware;
  x.joint = random.index(static_cast<int>(hardware.drives.size()));
  const DriveConfig& drive = hardware.drives[x.joint];
  x.bus = drive.bus;
  x.node = static_cast<std::uint32_t>(drive.node_id);
  x.counts_per_unit = drive.counts_per_unit;
  if (x.kind->where == Where::kTactile) {
    x.bus = hardware.tactile_modules.front().bus;
    x.node = static_cast<std::uint32_t>(random.index(4));
  }
  if (x.kind->where != Where::kBus) return;
  x.bus = random.index(static_cast<int>(hardware.buses.size()));
  if (random.chance(0.5)) return;
  static constexpr std::array<std::uint32_t, 5> kFunctions = {0x180, 0x200, 0x700, 0x580, 0x80};
  const bool is_tactile = x.bus == hardware.tactile_modules.front().bus;
  x.id = is_tactile ? 0x100 + x.node : kFunctions[random.index(5)] + x.node;
}

/// When all is over and quiet; now and then long after, or by somebody who does not wait.
int drawClear_ms(Random& random, const Plan& plan) {
  int end_ms = 0;
  for (const Injection& x : plan.injections)
    if (x.until_ms < kForever_ms) end_ms = std::max(end_ms, x.until_ms);
  if (random.chance(0.2)) return random.integer(10, end_ms + 100);
  return end_ms + (random.chance(0.04) ? 12'000 : random.integer(50, 1500));
}

/// A hand that comes before or during a hold and goes about when it ends.
void addHeldHand(Random& random, const Scene& scene, Plan& plan) {
  Injection off = drawInjection(random, scene, kindOf("enable_off"), random.integer(1, 200));
  off.until_ms = off.from_ms + static_cast<int>(random.logUniform(300.0, 20000.0));
  const int half_ms = (off.until_ms - off.from_ms) / 2;
  Injection x = drawInjection(random, scene, hand(),
                              std::max(0, off.from_ms + random.integer(-150, half_ms)));
  x.until_ms = std::max(x.from_ms + 100, off.until_ms + random.integer(-500, 200));
  plan.injections.insert(plan.injections.end(), {off, x});
}

/// A hand that was there and has gone, or goes, when the user switches on again.
void addLeavingHand(Random& random, const Scene& scene, Plan& plan) {
  const int from_ms = random.integer(0, plan.clear_ms);
  Injection x = drawInjection(random, scene, hand(), from_ms);
  x.until_ms = std::max(from_ms + 100, plan.clear_ms + random.integer(-300, 400));
  plan.injections.push_back(x);
}

}  // namespace

std::string Plan::text() const {
  std::string text = fmt::format("{}, {}:", kVariants[variant], kMoments[static_cast<int>(moment)]);
  for (const Injection& x : injections) {
    text += fmt::format(" {}", x.kind->name);
    if (x.kind->where == Where::kDrive) text += fmt::format(" j{}", x.joint + 1);
    if (x.kind->where == Where::kBus) text += fmt::format(" can{} id {:x}", x.bus, x.id);
    if (x.size != 0.0) text += fmt::format(" {:.3g}", x.size);
    text += x.kind->lasts || x.until_ms == kForever_ms
                ? fmt::format(" from {},", x.from_ms)
                : fmt::format(" {}..{},", x.from_ms, x.until_ms);
  }
  return text + fmt::format(" {} at {} ms", kEndings[static_cast<int>(ending)], clear_ms);
}

Injection drawInjection(Random& random, const Scene& scene, const InjectionKind& kind,
                        int from_ms) {
  Injection x;
  x.kind = &kind;
  x.from_ms = from_ms;
  x.until_ms = from_ms + drawDuration_ms(random, kind);
  x.size = random.sign() * random.uniform(kind.low, kind.high);
  if (kind.script) x.size = std::abs(x.size);
  x.period_ms = static_cast<int>(random.logUniform(1.0, 40.0));
  aim(random, scene, x);
  // Some who push put back again, and some drives are never mended.
  const bool may_last = &kind == &push() || (kind.send && kind.where == Where::kDrive);
  if (may_last && random.chance(0.5)) x.until_ms = kForever_ms;
  return x;
}

Plan drawPlan(std::uint64_t seed, std::uint64_t index, const Scene& scene) {
  Random random(mixed(seed, index));
  Plan plan;
  plan.variant = random.index(static_cast<int>(kVariants.size()));
  plan.moment = random.chance(0.07) ? Moment::kEnabling : static_cast<Moment>(random.integer(1, 3));
  const double many = random.uniform(0.0, 1.0);
  const int count = many < 0.1 ? 1 : many < 0.85 ? 2 : 3;
  int from_ms = random.integer(1, 200);
  for (int i = 0; i < count; ++i) {
    plan.injections.push_back(drawInjection(random, scene, drawKind(random), from_ms));
    from_ms += random.chance(0.2) ? 0 : random.integer(0, 200);
  }
  if (random.chance(0.12)) {
    plan.injections.resize(static_cast<std::size_t>(random.index(2)));  // and at most one more
    addHeldHand(random, scene, plan);
  }
  plan.clear_ms = drawClear_ms(random, plan);
  const double end = random.uniform(0.0, 1.0);
  plan.ending = end < 0.4    ? Ending::kGoOn
                : end < 0.7  ? Ending::kGoOnStop
                : end < 0.85 ? Ending::kStop
                             : Ending::kLeave;
  plan.off_ms = static_cast<int>(random.logUniform(50.0, 600.0));
  if (random.chance(0.2)) plan.bounce_ms = random.integer(1, 30);
  if (plan.ending <= Ending::kGoOnStop && random.chance(0.25)) addLeavingHand(random, scene, plan);
  return plan;
}

}  // namespace tactus::campaign
