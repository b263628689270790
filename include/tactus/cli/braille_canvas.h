#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tactus/cli/scope_trace.h"

namespace tactus {

/// What a plot covers; its upper and right ends are in it.
struct PlotRange {
  double from_s, to_s, low, high;
};

/// Dots of 2 x 4 a character, U+2800 to U+28FF, in colours by SGR codes; a character has the colour
/// that was drawn last.
class BrailleCanvas {
 public:
  BrailleCanvas(int columns, int rows, const PlotRange& range);

  /// Of every `period` dots along the curve `share` are drawn. What is outside, or not finite, is
  /// not drawn.
  void draw(const ScopeCurve& curve, int colour, int share = 1, int period = 1);
  void drawLevel(double value, int colour, int share, int period);
  void drawTime(double t_s, int colour, int share, int period);

  /// A row from the top, in UTF-8, without its line break.
  std::string row(int row, bool has_colour) const;

 private:
  struct Cell {
    std::uint8_t dots = 0;
    int colour = 0;  ///< SGR; 0: none
  };

  int dotColumn(double t_s) const noexcept;
  int dotRow(double value) const noexcept;
  void set(int x, int y, int colour) noexcept;
  void line(int x0, int y0, int x1, int y1, int colour, int share, int period, int& drawn) noexcept;

  int columns_, rows_;
  PlotRange range_;
  std::vector<Cell> cells_;
};

}  // namespace tactus
