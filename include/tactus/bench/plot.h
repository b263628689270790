#pragma once

#include <string>
#include <vector>

#include "tactus/bench/table.h"

namespace tactus {

/// The rows of a plot's table that match, in their order.
struct Series {
  std::string label;
  Filter filter;
};

enum class Scale { kLinear, kLogarithmic };

/// One figure of the report, which tools/tactus_report draws from the table's CSV file. What has no
/// place on a logarithmic axis (zero, negative) and what was not measured is left out.
struct Plot {
  std::string title;
  std::string note;   ///< what to see in it
  std::string table;  ///< one of the same study's
  std::string x_column, y_column;
  std::string x_label, y_label;
  Scale x_scale = Scale::kLogarithmic, y_scale = Scale::kLogarithmic;
  bool has_lines = true;  ///< between the points of a series
  std::vector<Series> series;
};

}  // namespace tactus
