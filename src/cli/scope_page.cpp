#include "tactus/cli/scope_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr double kWidth = 960.0, kLeft = 60.0, kRight = 20.0, kTop = 14.0, kBottom = 34.0;
constexpr double kForceHeight = 420.0, kSignalHeight = 200.0;
constexpr std::size_t kMostPoints = 2000;
constexpr std::size_t kColours = 6;

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ink: #1c2328; --faint: #8a949c; --grid: #dfe4e8; --page: #fff;
  --rest: #a15c00; --predicted: #a3319f;
  --c0: #0a7d3c; --c1: #1f6fb4; --c2: #6a5acd; --c3: #00808a; --c4: #7a6a00; --c5: #59636b; }
@media (prefers-color-scheme: dark) { :root { --ink: #e3e8ec; --faint: #87929b; --grid: #323b42;
  --page: #14191d; --rest: #f0a64a; --predicted: #e17ddd;
  --c0: #4fd38a; --c1: #6db5f2; --c2: #a99bf5; --c3: #53c9d1; --c4: #d2c14e; --c5: #a3adb5; } }
body { margin: 2em auto; max-width: 62em; padding: 0 1em; background: var(--page); color: var(--ink);
  font: 15px/1.45 system-ui, sans-serif; }
svg { width: 100%; height: auto; } svg text { fill: var(--ink); font-size: 12px; }
.grid { stroke: var(--grid); stroke-width: 1; } .trigger { stroke: var(--faint); stroke-dasharray: 2 4; }
.band { fill: var(--rest); opacity: 0.14; }
.rest { stroke: var(--rest); stroke-width: 1.5; stroke-dasharray: 8 5; }
polyline { fill: none; stroke-width: 1.3; stroke-linejoin: round; }
.newest { stroke-width: 2.2; }
.predicted { stroke: var(--predicted); stroke-width: 1.8; stroke-dasharray: 2 4; }
.k0 { stroke: var(--c0); } .k1 { stroke: var(--c1); } .k2 { stroke: var(--c2); }
.k3 { stroke: var(--c3); } .k4 { stroke: var(--c4); } .k5 { stroke: var(--c5); }
.wide { overflow-x: auto; } table { border-collapse: collapse; white-space: nowrap; }
th, td { padding: 0.2em 0.7em; text-align: right; border-bottom: 1px solid var(--grid); }
td.text, th.text { text-align: left; } .key { display: inline-block; width: 2em; height: 0.8em; }
figcaption { color: var(--faint); }
)";

/// Of text from files, too.
std::string inHtml(std::string_view text) {
  std::string result;
  for (const char c : escaped(text)) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

/// Coordinates of a drawing.
struct Drawing {
  PlotRange range;
  double height;

  double x(double t_s) const {
    return kLeft + (t_s - range.from_s) / (range.to_s - range.from_s) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    const double clamped = std::clamp(value, range.low, range.high);
    return kTop + (range.high - clamped) / (range.high - range.low) * (height - kTop - kBottom);
  }
};

/// 1, 2 or 5 times a power of ten, some six of them in the range.
double gridStep(double low, double high) {
  const double rough = (high - low) / 6.0;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= rough) return step * decade;
  return 10.0 * decade;
}

/// Of the range. Bounded: of numbers so large that a step is less than their last digit there are
/// none to be told apart.
std::vector<double> gridLines(double low, double high) {
  constexpr int kMost = 20;
  const double step = gridStep(low, high), first = std::ceil(low / step);
  std::vector<double> lines;
  for (int i = 0; i < kMost && (first + i) * step <= high; ++i) {
    const double line = (first + i) * step + 0.0;  // no -0
    if (lines.empty() || line > lines.back()) lines.push_back(line);
  }
  return lines;
}

std::string gridOf(const Drawing& drawing) {
  const PlotRange& range = drawing.range;
  std::string svg;
  for (const double value : gridLines(range.low, range.high)) {
    const double y = drawing.y(value);
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
        kLeft, kWidth - kRight, y, y, kLeft - 6.0, y + 4.0, value);
  }
  for (const double t_s : gridLines(range.from_s, range.to_s)) {
    const double x = drawing.x(t_s);
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{}\" y2=\"{}\"/>"
        "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:g}</text>\n",
        x, x, kTop, drawing.height - kBottom, x, drawing.height - kBottom + 16.0, t_s);
  }
  return svg + fmt::format(
                   "<line class=\"trigger\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" "
                   "y2=\"{2}\"><title>trigger</title></line>\n",
                   drawing.x(0.0), kTop, drawing.height - kBottom);
}

std::string curveOf(const Drawing& drawing, const ScopeCurve& curve, const std::string& kind,
                    const std::string& title) {
  const ScopeCurve thin = thinned(curve, kMostPoints);
  std::string points;
  for (std::size_t i = 0; i < thin.t_s.size(); ++i) {
    if (!std::isfinite(thin.value[i])) continue;
    if (thin.t_s[i] < drawing.range.from_s || thin.t_s[i] > drawing.range.to_s) continue;
    points += fmt::format("{:.1f},{:.1f} ", drawing.x(thin.t_s[i]), drawing.y(thin.value[i]));
  }
  return fmt::format("<polyline class=\"{}\" points=\"{}\"><title>{}</title></polyline>\n", kind,
                     points, inHtml(title));
}

std::string levelOf(const Drawing& drawing, double value, const std::string& title) {
  return fmt::format(
      "<line class=\"rest\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\">"
      "<title>{}</title></line>\n",
      kLeft, kWidth - kRight, drawing.y(value), drawing.y(value), inHtml(title));
}

std::string figureOf(const Drawing& drawing, const std::string& label, const std::string& body,
                     const std::string& caption) {
  return fmt::format(
      "<figure><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{}{}"
      "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">s since the trigger</text></svg>\n"
      "<figcaption>{}</figcaption></figure>\n",
      kWidth, drawing.height, inHtml(label), gridOf(drawing), body, kWidth - kRight,
      drawing.height - 4.0, inHtml(caption));
}

std::size_t ageOf(const ScopeView& view, std::size_t i) { return view.traces.size() - 1 - i; }

std::string kindOf(const ScopeView& view, std::size_t i) {
  const std::size_t age = ageOf(view, i);
  return fmt::format("k{}{}", std::min(age, kColours - 1), age == 0 ? " newest" : "");
}

std::string titleOf(const ScopeTrace& trace) {
  return fmt::format("{:.3f} s on {}: peak {:.2f} N; {}; {}; {}", trace.trigger_s, trace.link,
                     trace.peak_N, trace.variant, gainsText(trace), touchText(trace));
}

std::string restOf(const Drawing& drawing, const ScopeTrace& newest) {
  if (std::isnan(newest.rest_N)) return "";
  const double high = drawing.y(newest.rest_N * (1.0 + kDrawnBand));
  const double low = drawing.y(newest.rest_N * (1.0 - kDrawnBand));
  const std::string band = fmt::format(
      "<rect class=\"band\" x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\">"
      "<title>5 % about {:g} N</title></rect>\n",
      kLeft, high, kWidth - kLeft - kRight, low - high, newest.rest_N);
  return band +
         levelOf(drawing, newest.rest_N, fmt::format("{:g} N: where it shall rest", newest.rest_N));
}

std::string forceFigure(const ScopeView& view) {
  const Drawing drawing{forceRange(view), kForceHeight};
  const ScopeTrace& newest = view.traces.back();
  std::string svg = restOf(drawing, newest);
  if (!newest.predicted.t_s.empty())
    svg += curveOf(drawing, newest.predicted, "predicted",
                   "predicted for " + touchText(newest) + "; " + gainsText(newest));
  for (std::size_t i = 0; i < view.traces.size(); ++i)
    svg += curveOf(drawing, view.traces[i].force, kindOf(view, i), titleOf(view.traces[i]));
  const std::string prediction =
      newest.predicted.t_s.empty()
          ? "No prediction: " + newest.why_not_predicted + "."
          : std::string("Dotted, predicted for the newest: ") + kPredictionText;
  return figureOf(drawing, "Force of the contacts over time", svg,
                  fmt::format("F_sen in N. {} {}", restText(newest), prediction));
}

std::string signalFigure(const ScopeView& view) {
  const Drawing drawing{signalRange(view), kSignalHeight};
  const std::string level = fmt::format("level {:g} {}", view.condition.level, view.condition.unit);
  std::string svg = levelOf(drawing, view.condition.level, level);
  for (std::size_t i = 0; i < view.traces.size(); ++i)
    svg += curveOf(drawing, view.traces[i].signal, kindOf(view, i), titleOf(view.traces[i]));
  const std::string& name = view.condition.columns.front().name;
  const std::string unit = view.condition.unit.empty() ? "" : " in " + view.condition.unit;
  return figureOf(drawing, name, svg, name + unit + ". Dashed: the trigger's level.");
}

std::string tableOf(const ScopeView& view) {
  std::string html =
      "<div class=\"wide\"><table>\n<thead><tr><th class=\"text\">Curve</th><th>Trigger, s</th>"
      "<th class=\"text\">Link</th><th class=\"text\">Variant</th><th>Peak, N</th><th>T, s</th>"
      "<th>d</th><th>F_act, N</th><th>F_th, N</th><th>c, N/m</th>"
      "<th class=\"text\">The touch (interval of 95 %)</th></tr></thead>\n<tbody>\n";
  for (std::size_t i = view.traces.size(); i-- > 0;) {
    const ScopeTrace& trace = view.traces[i];
    const ForceGains& gains = trace.gains;
    html += fmt::format(
        "<tr><td class=\"text\"><span class=\"key\" style=\"background: var(--c{})\"></span>{}</td>"
        "<td>{:.3f}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{:.2f}</td>"
        "<td>{:g}</td><td>{:g}</td><td>{:g}</td><td>{:g}</td><td>{:.0f}</td>"
        "<td class=\"text\">{}</td></tr>\n",
        std::min(ageOf(view, i), kColours - 1), ageOf(view, i) == 0 ? " newest" : "",
        trace.trigger_s, inHtml(trace.link), inHtml(trace.variant), trace.peak_N,
        gains.time_constant_s, gains.damping, gains.activation_force_N, gains.contact_threshold_N,
        trace.law_stiffness_N_per_m, inHtml(touchText(trace)));
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace

std::string scopePage(const ScopeView& view) {
  const std::string trigger =
      view.traces.back().is_triggered ? "0 s is the trigger" : "0 s is now, there was no trigger";
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Contacts, {0}</title>\n<style>{1}</style></head>\n<body>\n<h1>Contacts</h1>\n"
      "<p>{0}: <code>{2}</code>, {3}.</p>\n",
      inHtml(view.log), kStyle, inHtml(view.condition.text), trigger);
  html += forceFigure(view);
  if (!view.condition.isOfForce()) html += signalFigure(view);
  return html + tableOf(view) + "</body></html>\n";
}

}  // namespace tactus
