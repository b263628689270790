#include "campaign/mode_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "campaign/play.h"
#include "tactus/scene/source_hash.h"

namespace tactus::campaign {
namespace {

using test::Random;

constexpr int kLongestSpan_ms = 300;  ///< of a mode that is looked at
constexpr int kRunningAfter_ms = 20;

/// How a mode is brought about: troubles before the one that is looked at.
struct Stance {
  const char* name;
  Mode mode;
  Moment moment;
  const char* kind;  ///< nullptr: by itself
  int from_ms;
  int until_ms;  ///< of what brings it about; -1: it lasts until after the trouble's beginning
};

constexpr std::array<Stance, 8> kStances = {{
    {"boot", Mode::kBoot, Moment::kBoot, nullptr, 0, 0},
    {"ready", Mode::kReady, Moment::kReady, "enable_off", 0, -1},
    {"enabling", Mode::kEnabling, Moment::kReady, nullptr, 0, 0},
    {"running", Mode::kRunning, Moment::kFirm, nullptr, 0, 0},
    {"retreating", Mode::kRetreating, Moment::kFirm, "tactile_cable_break", 5, 40},
    {"holding", Mode::kHolding, Moment::kFirm, "enable_off", 5, -1},
    {"stopping", Mode::kStopping, Moment::kFree, "late_cycles", 5, 30},
    {"fault", Mode::kFault, Moment::kFirm, "emergency_stop", 5, 30},
}};

struct Span {
  int begin_ms = 0, duration_ms = 0;
};

Plan stancePlan(const Stage& stage, const Stance& stance, int until_ms) {
  return latePlan(stage, stance.moment, Ending::kGoOnStop, stance.kind, stance.from_ms,
                  stance.until_ms >= 0 ? stance.until_ms : until_ms);
}

/// When the mode begins, and for how long it lasts, undisturbed.
Span spanOf(const Stage& stage, const Stance& stance) {
  if (stance.mode == Mode::kRunning) return {kRunningAfter_ms, kLongestSpan_ms};
  const Plan plan = stancePlan(stage, stance, 10'000);
  Play play(stage, plan);
  Span span{-1, 0};
  for (int i = 0; i < 6000 && span.duration_ms < kLongestSpan_ms; ++i) {
    const bool is_there = play.now().mode == stance.mode;
    if (is_there && span.begin_ms < 0) span.begin_ms = play.now_ms();
    if (is_there) span.duration_ms = play.now_ms() - span.begin_ms;
    if (!is_there && span.begin_ms >= 0) break;
    play.step(play.input());
  }
  return span;
}

struct Phase {
  int from_ms;
  bool is_reversed;
};

/// The cycle in which the mode begins and the nine after it, five over the mode's duration, and
/// five of these with frames in reverse order.
Phase phaseOf(const Span& span, int phase) {
  static constexpr std::array<int, 5> kReversed = {0, 1, 3, 12, 14};
  if (phase >= 15)
    return {phaseOf(span, kReversed[static_cast<std::size_t>(phase) - 15]).from_ms, true};
  const int after_ms = phase < 10 ? phase : std::max(phase, span.duration_ms * (phase - 9) / 5);
  return {std::max(0, span.begin_ms - 1 + after_ms), false};
}

/// By its name alone, the same on every machine.
Injection troubleOf(const Stage& stage, const InjectionKind& kind, const std::string& name,
                    int from_ms) {
  Random random(sourceHash(name));
  Injection x = drawInjection(random, stage.scene, kind, from_ms);
  x.until_ms = from_ms + kTrouble_ms;
  return x;
}

/// When a stop must be over: a retreat takes 1.5 s at most, drives that are cut off 0.8 s.
void setUser(Plan& plan, bool may_retreat) {
  int end_ms = 0;
  for (const Injection& x : plan.injections) end_ms = std::max(end_ms, x.until_ms);
  plan.clear_ms = end_ms + (may_retreat ? 1500 : 900);
}

bool mayRetreat(const InjectionKind& kind) { return kind.where == InjectionKind::Where::kTactile; }

Case modeCase(const Stage& stage, const Stance& stance, const Span& span, const InjectionKind& kind,
              int phase) {
  Case one{fmt::format("mode {} {} {}", kind.name, stance.name, phase), {}};
  const Phase at = phaseOf(span, phase);
  one.plan = stancePlan(stage, stance, at.from_ms + 100);
  if (stance.mode == Mode::kRunning && phase % 2 == 1) one.plan.moment = Moment::kFree;
  one.plan.injections.push_back(troubleOf(stage, kind, one.name, at.from_ms));
  if (at.is_reversed) {
    one.plan.reversed_from_ms = at.from_ms;
    one.plan.reversed_until_ms = at.from_ms + kTrouble_ms;
  }
  setUser(one.plan, mayRetreat(kind) || stance.mode == Mode::kRetreating);
  return one;
}

}  // namespace

void addModeCases(const Stage& stage, std::vector<Case>& cases) {
  for (const Stance& stance : kStances) {
    const Span span = spanOf(stage, stance);
    for (const InjectionKind* kind : injectionKinds())
      for (int phase = 0; phase < kPhases; ++phase)
        cases.push_back(modeCase(stage, stance, span, *kind, phase));
  }
}

void addPairCases(const Stage& stage, std::vector<Case>& cases) {
  static constexpr std::array<int, 2> kDistances_ms = {2, 60};
  const Stance& running = kStances[3];
  for (const InjectionKind* first : injectionKinds())
    for (const InjectionKind* second : injectionKinds())
      for (const int distance_ms : kDistances_ms) {
        Case one{fmt::format("pair {} {} {}", first->name, second->name, distance_ms), {}};
        one.plan = stancePlan(stage, running, 0);
        if (cases.size() % 2 == 1) one.plan.moment = Moment::kFree;
        one.plan.injections = {troubleOf(stage, *first, one.name + " first", kRunningAfter_ms),
                               troubleOf(stage, *second, one.name, kRunningAfter_ms + distance_ms)};
        setUser(one.plan, mayRetreat(*first) || mayRetreat(*second));
        cases.push_back(one);
      }
}

}  // namespace tactus::campaign
