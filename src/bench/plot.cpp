#include "tactus/bench/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kWidth = 760.0, kHeight = 380.0;  // user units of the drawing
constexpr double kLeft = 70.0, kRight = 530.0, kTop = 12.0, kBottom = 330.0;
constexpr double kLegendStep = 17.0;

/// Colour and shape together tell more series apart than there are colours.
constexpr int kColours = 8;

/// From values to a length of the drawing.
class Axis {
 public:
  Axis(Scale scale, const std::vector<double>& values, double from, double to)
      : scale_(scale), from_(from), to_(to) {
    low_ = high_ = values.empty() ? 0.0 : toLinear(values.front());
    for (const double value : values) {
      low_ = std::min(low_, toLinear(value));
      high_ = std::max(high_, toLinear(value));
    }
    if (scale_ == Scale::kLinear) low_ = std::min(low_, 0.0);
    const double step = tickStep();
    low_ = step * std::floor(low_ / step + 1e-9);
    high_ = step * std::ceil(high_ / step - 1e-9);
    if (high_ - low_ < 0.5 * step) high_ = low_ + step;
  }

  double place(double value) const {
    return from_ + (to_ - from_) * (toLinear(value) - low_) / (high_ - low_);
  }

  std::vector<double> ticks() const {
    const double step = tickStep();
    std::vector<double> result;
    for (double tick = low_; tick <= high_ + 1e-6 * step; tick += step)
      result.push_back(scale_ == Scale::kLinear ? tick : std::pow(10.0, tick));
    return result;
  }

 private:
  double toLinear(double value) const {
    return scale_ == Scale::kLinear ? value : std::log10(value);
  }

  /// Not more than about eight ticks; below two decades also a half, about 3.16.
  double tickStep() const {
    const double range = std::max(high_ - low_, 1e-12);
    if (scale_ == Scale::kLogarithmic) return range <= 2.0 ? 0.5 : std::ceil(range / 8.0);
    const double power = std::pow(10.0, std::floor(std::log10(range)));
    return range / power <= 2.0 ? 0.25 * power : range / power <= 4.0 ? 0.5 * power : power;
  }

  Scale scale_;
  double from_, to_;
  double low_ = 0.0, high_ = 0.0;
};

bool fits(Scale scale, double value) {
  return std::isfinite(value) && (scale == Scale::kLinear || value > 0.0);
}

std::vector<double> values(const Plot& plot, int coordinate) {
  const std::array<Scale, 2> scales = {plot.x_scale, plot.y_scale};
  std::vector<double> result;
  for (const Series& series : plot.series) {
    for (const std::array<double, 2>& point : series.points) {
      if (fits(scales[0], point[0]) && fits(scales[1], point[1]))
        result.push_back(point[coordinate]);
    }
  }
  return result;
}

std::string marker(std::size_t series, double x, double y) {
  switch (series / kColours % 3) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>", x, y);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"6\" height=\"6\"/>", x - 3.0,
                         y - 3.0);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l4 7h-8z\"/>", x, y - 4.0);
  }
}

std::string drawAxes(const Plot& plot, const Axis& x, const Axis& y) {
  std::string text;
  for (const double tick : x.ticks()) {
    const double at = x.place(tick);
    text += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} {1}V{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4:.3g}</text>\n",
        at, kTop, kBottom, kBottom + 18.0, tick);
  }
  for (const double tick : y.ticks()) {
    const double at = y.place(tick);
    text += fmt::format(
        "<path class=\"grid\" d=\"M{1} {0:.1f}H{2}\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5:.3g}</text>\n",
        at, kLeft, kRight, kLeft - 6.0, at + 4.0, tick);
  }
  text += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                      0.5 * (kLeft + kRight), kBottom + 40.0, escapeHtml(plot.x_label));
  text += fmt::format(
      "<text transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      0.5 * (kTop + kBottom), escapeHtml(plot.y_label));
  return text;
}

std::string drawSeries(const Plot& plot, std::size_t index, const Axis& x, const Axis& y) {
  const Series& series = plot.series[index];
  std::string markers, line;
  for (const std::array<double, 2>& point : series.points) {
    if (!fits(plot.x_scale, point[0]) || !fits(plot.y_scale, point[1])) continue;
    markers += marker(index, x.place(point[0]), y.place(point[1]));
    line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", x.place(point[0]),
                        y.place(point[1]));
  }
  const double legend_y = kTop + 8.0 + kLegendStep * static_cast<double>(index);
  std::string text = fmt::format("<g class=\"series c{}\">", index % kColours);
  if (plot.has_lines && !line.empty()) text += fmt::format("<path class=\"line\" d=\"{}\"/>", line);
  text += markers + marker(index, kRight + 20.0, legend_y);
  text += fmt::format("<text x=\"{}\" y=\"{:.1f}\">{}</text></g>\n", kRight + 30.0, legend_y + 4.0,
                      escapeHtml(series.label));
  return text;
}

}  // namespace

Series select(const Table& table, const std::string& label, std::string_view x_column,
              std::string_view y_column, const Filter& filter) {
  Series series{label, {}};
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (matches(table, row, filter))
      series.points.push_back({table.number(row, x_column), table.number(row, y_column)});
  }
  return series;
}

std::string svgText(const Plot& plot) {
  const Axis x(plot.x_scale, values(plot, 0), kLeft, kRight);
  const Axis y(plot.y_scale, values(plot, 1), kBottom, kTop);
  const double legend_height = kTop + kLegendStep * static_cast<double>(plot.series.size() + 1);
  std::string text = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                                 kWidth, std::max(kHeight, legend_height), escapeHtml(plot.title));
  text += drawAxes(plot, x, y);
  for (std::size_t i = 0; i < plot.series.size(); ++i) text += drawSeries(plot, i, x, y);
  return text + "</svg>\n";
}

std::string escapeHtml(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

}  // namespace tactus
