#include "campaign/injection.h"

namespace tactus::campaign {
namespace {

const InjectionKind kKindsLine[] = {
    {.name = "enable_off",
     .where = InjectionKind::Where::kLines,
     .input = [](Injection&, CycleInput& in) { in.lines.enable = false; }},
    {.name = "enable_flicker",
     .where = InjectionKind::Where::kLines,
     .input = [](Injection& x,
                 CycleInput& in) { in.lines.enable &= x.t_ms / x.period_ms % 2 == 1; }},
    {.name = "emergency_stop",
     .where = InjectionKind::Where::kLines,
     .detected_ms = 1,
     .input = [](Injection&, CycleInput& in) { in.lines.emergency_stop = true; }},
    {.name = "emergency_stop_pulses",
     .where = InjectionKind::Where::kLines,
     .input = [](Injection& x,
                 CycleInput& in) { in.lines.emergency_stop |= x.t_ms % (8 * x.period_ms) == 0; }},
    {.name = "stop_request",
     .where = InjectionKind::Where::kLines,
     .lasts = true,
     .input = [](Injection&, CycleInput& in) { in.stop_requested = true; }},
    {.name = "forbidden_call",
     .where = InjectionKind::Where::kLines,
     .detected_ms = 1,
     .lasts = true,
     .input = [](Injection&, CycleInput& in) { in.has_forbidden_call = true; }},
    {.name = "gpio_lost",
     .where = InjectionKind::Where::kLines,
     .detected_ms = 1,
     .input = [](Injection&, CycleInput& in) { in.are_lines_lost = !(in.lines.is_valid = false); }},
    {.name = "gpio_not_written",
     .where = InjectionKind::Where::kLines,
     .detected_ms = 1,
     .input = [](Injection&, CycleInput& in) { in.are_lines_lost = true; }},
    {.name = "missed_cycles",
     .where = InjectionKind::Where::kLines,
     .missed =
         [](Injection& x) {
           if (x.t_ms < x.next_ms) return 0;
           x.next_ms = x.t_ms + 20 + x.period_ms;
           return x.period_ms;
         }},
    {.name = "long_pause",
     .where = InjectionKind::Where::kLines,
     .missed = [](Injection& x) { return x.t_ms == 0 ? 20 * x.period_ms : 0; }},
    {.name = "late_cycles",
     .where = InjectionKind::Where::kLines,
     .detected_ms = 5,
     .input = [](Injection& x, CycleInput& in) { in.late_in_a_row = x.t_ms + 1; }},
};

}  // namespace

std::span<const InjectionKind> lineKinds() { return kKindsLine; }

}  // namespace tactus::campaign
