#include "tactus/scene/bus_load_text.h"

#include <fmt/format.h>

namespace tactus {
namespace {

constexpr double kCycleTolerance = 1e-9;

std::string describeTerm(const BusLoadTerm& term, double period_s) {
  const double cycles = term.period_s / period_s;
  const bool is_each_cycle = cycles > 1.0 - kCycleTolerance && cycles < 1.0 + kCycleTolerance;
  return fmt::format("{} x {:.4g}{} ({})", term.frames, term.bitsAFrame(),
                     is_each_cycle ? "" : fmt::format(" / {:.4g}", cycles), term.name);
}

}  // namespace

std::string describeBusLoad(const BusLoad& load, double period_s) {
  std::string sum;
  for (const BusLoadTerm& term : load.terms) {
    sum += (sum.empty() ? "" : " + ") + describeTerm(term, period_s);
  }
  return fmt::format("{} = {:.4g} bits a cycle of {:.4g} = {:.4g} %", sum,
                     load.bitsPerSecond() * period_s, load.bit_rate_per_s * period_s,
                     100.0 * load.share());
}

}  // namespace tactus
