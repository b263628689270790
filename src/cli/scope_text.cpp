#include "tactus/cli/scope_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr int kForceRows = 16, kSignalRows = 6;
constexpr int kAxisColumns = 8;
constexpr int kLeastColumns = 40;
constexpr int kGrey = 90, kNewest = 92, kPredicted = 95, kRest = 93;
constexpr std::array kOlder = {36, 34, 94, 96};

/// Breaks between words; further lines begin with two blanks.
std::string wrapped(const std::string& text, std::size_t columns) {
  std::string result, line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!line.empty() && line.size() + 1 + word.size() > columns) {
      result += line + "\n";
      line = "  " + word;
    } else {
      line += (line.empty() ? "" : " ") + word;
    }
    at = end + 1;
  }
  return result + line + "\n";
}

std::string coloured(const std::string& text, int colour, bool has_colour) {
  return has_colour ? fmt::format("\033[{}m{}\033[0m", colour, text) : text;
}

int colourOf(const ScopeView& view, std::size_t i) {
  const std::size_t age = view.traces.size() - 1 - i;
  return age == 0 ? kNewest : kOlder[(age - 1) % kOlder.size()];
}

/// Each trace has a row, or more where the screen is narrow.
std::string traceLines(const ScopeView& view, const ScopeScreen& screen) {
  std::string text;
  for (std::size_t i = view.traces.size(); i-- > 0;) {
    const ScopeTrace& trace = view.traces[i];
    const std::string line = fmt::format(
        "{} {:.3f} s {} {}: peak {:.2f} N; {}, {}; {}", i + 1 == view.traces.size() ? "*" : "-",
        trace.trigger_s, trace.is_triggered ? "on" : "without trigger, on", escaped(trace.link),
        trace.peak_N, trace.variant, gainsText(trace), touchText(trace));
    std::string lines = wrapped(line, static_cast<std::size_t>(screen.columns));
    lines.pop_back();
    text += coloured(lines, colourOf(view, i), screen.has_colour) + "\n";
  }
  return text;
}

/// The rows of a canvas with their values, and the times below.
std::string framed(const BrailleCanvas& canvas, int rows, const PlotRange& range,
                   const ScopeScreen& screen) {
  std::string text;
  for (int i = 0; i < rows; ++i) {
    const bool is_labelled = i == 0 || i == rows - 1 || i == rows / 2;
    const double value = range.high - (range.high - range.low) * i / (rows - 1);
    const std::string label = is_labelled ? fmt::format("{:.4g}", value) : "";
    text += fmt::format("{:>{}} {}\n", label, kAxisColumns - 1, canvas.row(i, screen.has_colour));
  }
  const std::string from = fmt::format("{:g}", range.from_s),
                    to = fmt::format("{:g} s", range.to_s);
  const int between = screen.columns - kAxisColumns - static_cast<int>(from.size() + to.size());
  return text + std::string(kAxisColumns, ' ') + from +
         std::string(static_cast<std::size_t>(std::max(1, between)), ' ') + to + "\n";
}

std::string forcePlot(const ScopeView& view, const ScopeScreen& screen) {
  const PlotRange range = forceRange(view);
  BrailleCanvas canvas(screen.columns - kAxisColumns, kForceRows, range);
  const ScopeTrace& newest = view.traces.back();
  canvas.drawTime(0.0, kGrey, 1, 4);
  if (!std::isnan(newest.rest_N)) {
    canvas.drawLevel(newest.rest_N * (1.0 - kDrawnBand), kGrey, 1, 6);
    canvas.drawLevel(newest.rest_N * (1.0 + kDrawnBand), kGrey, 1, 6);
    canvas.drawLevel(newest.rest_N, kRest, 4, 8);
  }
  canvas.draw(newest.predicted, kPredicted, 1, 3);
  for (std::size_t i = 0; i < view.traces.size(); ++i)
    canvas.draw(view.traces[i].force, colourOf(view, i));
  return framed(canvas, kForceRows, range, screen);
}

std::string signalPlot(const ScopeView& view, const ScopeScreen& screen) {
  const PlotRange range = signalRange(view);
  BrailleCanvas canvas(screen.columns - kAxisColumns, kSignalRows, range);
  canvas.drawTime(0.0, kGrey, 1, 4);
  canvas.drawLevel(view.condition.level, kRest, 4, 8);
  for (std::size_t i = 0; i < view.traces.size(); ++i)
    canvas.draw(view.traces[i].signal, colourOf(view, i));
  return framed(canvas, kSignalRows, range, screen);
}

std::string legend(const ScopeView& view, std::size_t columns) {
  const ScopeTrace& newest = view.traces.back();
  const std::string text =
      wrapped("Force in N. Solid: F_sen, * the newest. " + restText(newest), columns);
  if (newest.predicted.t_s.empty())
    return text + wrapped("No prediction: " + newest.why_not_predicted + ".", columns);
  return text + wrapped(std::string("Dotted, predicted: ") + kPredictionText, columns);
}

PlotRange timesOf(const ScopeView& view) {
  PlotRange range{-view.pre_s, view.post_s, kNoLimit, -kNoLimit};
  for (const ScopeTrace& trace : view.traces)
    if (!trace.is_triggered) range = {-view.pre_s - view.post_s, 0.0, kNoLimit, -kNoLimit};
  return range;
}

void widen(const ScopeCurve& curve, PlotRange& range) {
  for (const double value : curve.value) {
    if (!std::isfinite(value)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
}

}  // namespace

PlotRange forceRange(const ScopeView& view) {
  PlotRange range = timesOf(view);
  for (const ScopeTrace& trace : view.traces) {
    widen(trace.force, range);
    if (!std::isnan(trace.rest_N))
      range.high = std::max(range.high, trace.rest_N * (1.0 + 2.0 * kDrawnBand));
  }
  if (!(range.high > 0.0)) range.high = 1.0;  // nothing was felt
  // A prediction that goes through the roof shall not hide what was measured.
  const double measured = range.high;
  if (!view.traces.empty()) widen(view.traces.back().predicted, range);
  range.high = 1.05 * std::min(range.high, 2.0 * measured);
  range.low = 0.0;
  return range;
}

PlotRange signalRange(const ScopeView& view) {
  PlotRange range = timesOf(view);
  for (const ScopeTrace& trace : view.traces) widen(trace.signal, range);
  range.low = std::min(range.low, view.condition.level);
  range.high = std::max(range.high, view.condition.level);
  if (!(range.high > range.low)) {
    const double margin = std::max(1.0, 1e-6 * std::abs(range.low));  // also of large numbers
    range.low -= margin;
    range.high += margin;
  }
  return range;
}

std::string scopeText(const ScopeView& view, const ScopeScreen& given) {
  ScopeScreen screen = given;
  screen.columns = std::max(screen.columns, kLeastColumns);
  const auto columns = static_cast<std::size_t>(screen.columns);
  std::string text = wrapped(
      fmt::format("{}: {}; 0 s is {}", escaped(view.log), escaped(view.condition.text),
                  view.traces.back().is_triggered ? "the trigger" : "now, there was no trigger"),
      columns);
  text += traceLines(view, screen) + forcePlot(view, screen);
  if (!view.condition.isOfForce()) {
    text += wrapped(view.condition.columns.front().name +
                        (view.condition.unit.empty() ? "" : " in " + view.condition.unit) +
                        ", dashed the trigger's level:",
                    columns) +
            signalPlot(view, screen);
  }
  return text + legend(view, columns);
}

}  // namespace tactus
