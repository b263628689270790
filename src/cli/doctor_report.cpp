#include "tactus/cli/doctor_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "tactus/record/time_figures.h"

namespace tactus {
namespace {

std::string_view shownLevel(Level level) {
  return level == Level::kNotFit ? "not fit" : levelName(level);
}

long long countOf(const std::vector<Finding>& findings, Level level) {
  return std::ranges::count(findings, level, &Finding::level);
}

double microseconds(long long time_ns) { return 1e-3 * static_cast<double>(time_ns); }

std::string timesText(const char* name, const Histogram& times) {
  const TimeFigures figures = timeFigures(times);
  return fmt::format("{:<14}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}\n", name,
                     microseconds(figures.min), microseconds(figures.median),
                     microseconds(figures.p99), microseconds(figures.max));
}

/// Counts below each power of two of nanoseconds, by its exponent.
std::map<int, long long> octaves(const Histogram& times) {
  std::map<int, long long> counts;
  times.forEachBucket([&](std::int64_t highest_ns, std::uint64_t count) {
    const auto exponent = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(highest_ns)));
    counts[exponent] += static_cast<long long>(count);
  });
  return counts;
}

std::string histogramText(const LoopMeasurement& measured) {
  const std::map<int, long long> waking = octaves(measured.wake_latency);
  const std::map<int, long long> steps = octaves(measured.step);
  if (waking.empty() || steps.empty()) return "";
  const auto countIn = [](const std::map<int, long long>& counts, int octave) {
    const auto found = counts.find(octave);
    return found == counts.end() ? 0 : found->second;
  };
  std::string text = fmt::format("{:<14}{:>10}{:>10}\n", "below us", "wake-ups", "steps");
  const int last = std::max(waking.rbegin()->first, steps.rbegin()->first);
  for (int octave = std::min(waking.begin()->first, steps.begin()->first); octave <= last; ++octave)
    text += fmt::format("{:<14.2f}{:>10}{:>10}\n", 1e-3 * std::exp2(octave),
                        countIn(waking, octave), countIn(steps, octave));
  return text;
}

std::string findingText(const Finding& finding) {
  std::string text =
      fmt::format("{:<9}{:<17}{}\n", shownLevel(finding.level), finding.name, finding.what);
  if (!finding.why_it_matters.empty())
    text += fmt::format("{:>26}why: {}\n", "", finding.why_it_matters);
  if (!finding.how_to_mend.empty())
    text += fmt::format("{:>26}mend: {}\n", "", finding.how_to_mend);
  return text;
}

Json histogramJson(const Histogram& times) {
  Json json = Json::array();
  times.forEachBucket([&](std::int64_t highest_ns, std::uint64_t count) {
    json.push_back({{"up_to_ns", highest_ns}, {"count", count}});
  });
  return json;
}

Json findingJson(const Finding& finding) {
  Json json = {{"name", finding.name}, {"level", levelName(finding.level)}, {"what", finding.what}};
  if (!finding.why_it_matters.empty()) json["why_it_matters"] = finding.why_it_matters;
  if (!finding.how_to_mend.empty()) json["how_to_mend"] = finding.how_to_mend;
  return json;
}

Json measuredJson(const LoopMeasurement& measured) {
  return {{"period_s", measured.period_s},
          {"cycles", measured.cycles},
          {"missed_cycles", measured.missed_cycles},
          {"page_faults", measured.page_faults},
          {"wake_latency_ns", timesJson(timeFigures(measured.wake_latency))},
          {"step_ns", timesJson(timeFigures(measured.step))},
          {"wake_latency_histogram", histogramJson(measured.wake_latency)},
          {"step_histogram", histogramJson(measured.step)}};
}

}  // namespace

std::string doctorText(const std::vector<Finding>& findings, const LoopMeasurement& measured) {
  std::string text;
  for (const Finding& finding : findings) text += findingText(finding);
  text += fmt::format("\n{} cycles of {:g} us, {} missed, {} page faults\n", measured.cycles,
                      1e6 * measured.period_s, measured.missed_cycles, measured.page_faults);
  text += fmt::format("{:<14}{:>10}{:>10}{:>10}{:>10}\n", "us", "min", "median", "p99", "max");
  text += timesText("waking late", measured.wake_latency) + timesText("step", measured.step) + "\n";
  text += histogramText(measured);
  const long long warnings = countOf(findings, Level::kWarning);
  text += fmt::format("\n{}: {} to mend, {} {}\n", isFit(findings) ? "fit" : "NOT FIT",
                      countOf(findings, Level::kNotFit), warnings,
                      warnings == 1 ? "warning" : "warnings");
  return text;
}

Json doctorJson(const std::vector<Finding>& findings, const LoopMeasurement& measured) {
  Json json = {{"fit", isFit(findings)}, {"findings", Json::array()}};
  for (const Finding& finding : findings) json["findings"].push_back(findingJson(finding));
  json["loop"] = measuredJson(measured);
  return json;
}

}  // namespace tactus
