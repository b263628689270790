#include "tactus/cli/doctor_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "tactus/record/time_figures.h"
#include "tactus/scene/json.h"

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

void writeHistogram(const char* name, const Histogram& times, JsonWriter& json) {
  json.key(name).beginArray();
  times.forEachBucket([&](std::int64_t highest_ns, std::uint64_t count) {
    json.beginObject();
    json.key("up_to_ns").value(static_cast<long long>(highest_ns));
    json.key("count").value(static_cast<long long>(count));
    json.endObject();
  });
  json.endArray();
}

void writeFinding(const Finding& finding, JsonWriter& json) {
  json.beginObject();
  json.key("name").value(finding.name);
  json.key("level").value(levelName(finding.level));
  json.key("what").value(finding.what);
  if (!finding.why_it_matters.empty()) json.key("why_it_matters").value(finding.why_it_matters);
  if (!finding.how_to_mend.empty()) json.key("how_to_mend").value(finding.how_to_mend);
  json.endObject();
}

void writeMeasured(const LoopMeasurement& measured, JsonWriter& json) {
  json.key("loop").beginObject();
  json.key("period_s").value(measured.period_s);
  json.key("cycles").value(measured.cycles);
  json.key("missed_cycles").value(measured.missed_cycles);
  json.key("page_faults").value(measured.page_faults);
  writeTimes("wake_latency_ns", timeFigures(measured.wake_latency), json);
  writeTimes("step_ns", timeFigures(measured.step), json);
  writeHistogram("wake_latency_histogram", measured.wake_latency, json);
  writeHistogram("step_histogram", measured.step, json);
  json.endObject();
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

std::string doctorJson(const std::vector<Finding>& findings, const LoopMeasurement& measured) {
  JsonWriter json;
  json.beginObject();
  json.key("fit").value(isFit(findings));
  json.key("findings").beginArray();
  for (const Finding& finding : findings) writeFinding(finding, json);
  json.endArray();
  writeMeasured(measured, json);
  json.endObject();
  return json.text();
}

}  // namespace tactus
