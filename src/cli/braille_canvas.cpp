#include "tactus/cli/braille_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tactus {
namespace {

constexpr int kDotsAcross = 2, kDotsDown = 4;
/// Bits of U+2800, by row and column of the dot.
constexpr std::uint8_t kDots[kDotsDown][kDotsAcross] = {
    {0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};

std::string brailleCharacter(std::uint8_t dots) {
  return {static_cast<char>(0xe2), static_cast<char>(0xa0 + (dots >> 6)),
          static_cast<char>(0x80 + (dots & 0x3f))};
}

}  // namespace

BrailleCanvas::BrailleCanvas(int columns, int rows, const PlotRange& range)
    : columns_(columns),
      rows_(rows),
      range_(range),
      cells_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

int BrailleCanvas::dotColumn(double t_s) const noexcept {
  const double share = (t_s - range_.from_s) / (range_.to_s - range_.from_s);
  return static_cast<int>(std::lround(share * (kDotsAcross * columns_ - 1)));
}

int BrailleCanvas::dotRow(double value) const noexcept {
  const double share = (range_.high - value) / (range_.high - range_.low);
  return static_cast<int>(std::lround(share * (kDotsDown * rows_ - 1)));
}

void BrailleCanvas::set(int x, int y, int colour) noexcept {
  if (x < 0 || y < 0 || x >= kDotsAcross * columns_ || y >= kDotsDown * rows_) return;
  Cell& cell = cells_[static_cast<std::size_t>(y / kDotsDown) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(x / kDotsAcross)];
  cell.dots = static_cast<std::uint8_t>(cell.dots | kDots[y % kDotsDown][x % kDotsAcross]);
  cell.colour = colour;
}

void BrailleCanvas::line(int x0, int y0, int x1, int y1, int colour, int share, int period,
                         int& drawn) noexcept {
  const int steps = std::max({1, std::abs(x1 - x0), std::abs(y1 - y0)});
  for (int i = 1; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    if (drawn++ % period >= share) continue;
    set(x0 + static_cast<int>(std::lround(part * (x1 - x0))),
        y0 + static_cast<int>(std::lround(part * (y1 - y0))), colour);
  }
}

void BrailleCanvas::draw(const ScopeCurve& curve, int colour, int share, int period) {
  int drawn = 0, x0 = 0, y0 = 0;
  bool has_before = false;
  for (std::size_t i = 0; i < curve.t_s.size(); ++i) {
    const bool is_inside = curve.t_s[i] >= range_.from_s && curve.t_s[i] <= range_.to_s &&
                           std::isfinite(curve.value[i]);
    if (!is_inside) {
      has_before = false;
      continue;
    }
    const int x = dotColumn(curve.t_s[i]);
    // Lines of what leaves the plot end at its edge.
    const int y = dotRow(std::clamp(curve.value[i], range_.low, range_.high));
    if (!has_before) {
      x0 = x;
      y0 = y;
      set(x, y, colour);
    }
    if (x != x0 || y != y0) line(x0, y0, x, y, colour, share, period, drawn);
    x0 = x;
    y0 = y;
    has_before = true;
  }
}

void BrailleCanvas::drawLevel(double value, int colour, int share, int period) {
  if (value < range_.low || value > range_.high) return;
  for (int x = 0; x < kDotsAcross * columns_; ++x)
    if (x % period < share) set(x, dotRow(value), colour);
}

void BrailleCanvas::drawTime(double t_s, int colour, int share, int period) {
  if (t_s < range_.from_s || t_s > range_.to_s) return;
  for (int y = 0; y < kDotsDown * rows_; ++y)
    if (y % period < share) set(dotColumn(t_s), y, colour);
}

std::string BrailleCanvas::row(int row, bool has_colour) const {
  std::string text;
  int colour = 0;
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  for (std::size_t i = first; i < first + static_cast<std::size_t>(columns_); ++i) {
    const int wanted = cells_[i].dots == 0 ? 0 : cells_[i].colour;
    if (has_colour && wanted != colour) text += fmt::format("\033[{}m", wanted);
    colour = wanted;
    text += cells_[i].dots == 0 ? " " : brailleCharacter(cells_[i].dots);
  }
  if (has_colour && colour != 0) text += "\033[0m";
  return text;
}

}  // namespace tactus
