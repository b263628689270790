#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tactus/scene/json.h"

namespace tactus {

/// A number or a word. A number that is not finite was not measured: its place stays empty.
using Cell = std::variant<double, std::string>;

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// What a study measured; becomes <name>.csv, and an array of objects in JSON.
struct Table {
  std::string name;
  std::vector<std::string> columns;  ///< units in the names
  std::vector<std::vector<Cell>> rows;

  /// Place of a column; throws std::out_of_range if there is none of that name.
  std::size_t column(std::string_view column_name) const;
  double number(std::size_t row, std::string_view column_name) const;
  const std::string& word(std::size_t row, std::string_view column_name) const;
};

/// Rows with these values in these columns.
using Filter = std::vector<std::pair<std::string, Cell>>;
bool matches(const Table& table, std::size_t row, const Filter& filter);

/// The number of the first row that matches; throws std::out_of_range if none does.
double findNumber(const Table& table, std::string_view column_name, const Filter& filter);

/// Two columns of the rows that match, in their order.
std::vector<std::array<double, 2>> findPoints(const Table& table, std::string_view x_column,
                                              std::string_view y_column, const Filter& filter);

/// RFC 4180; numbers are the shortest decimals that read back bit for bit.
std::string csvText(const Table& table);

Json tableJson(const Table& table);

}  // namespace tactus
