#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/bench/table.h"

namespace tactus {

struct Series {
  std::string label;
  std::vector<std::array<double, 2>> points;  ///< x, y
};

enum class Scale { kLinear, kLogarithmic };

/// One figure of the report. What has no place on a logarithmic axis (zero, negative) and what was
/// not measured is left out.
struct Plot {
  std::string title;
  std::string note;  ///< what to see in it
  std::string x_label, y_label;
  Scale x_scale = Scale::kLogarithmic, y_scale = Scale::kLogarithmic;
  bool has_lines = true;  ///< between the points of a series
  std::vector<Series> series;
};

/// The points of the rows that match, in their order.
Series select(const Table& table, const std::string& label, std::string_view x_column,
              std::string_view y_column, const Filter& filter);

/// One <svg> element, coloured by the page's style sheet.
std::string svgText(const Plot& plot);

/// &, <, > and " as HTML wants them.
std::string escapeHtml(std::string_view text);

}  // namespace tactus
