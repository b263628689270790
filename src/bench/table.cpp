#include "tactus/bench/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace tactus {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string cellText(const Cell& cell) {
  if (const std::string* word = std::get_if<std::string>(&cell)) return quoted(*word);
  const double number = std::get<double>(cell);
  return std::isfinite(number) ? fmt::format("{}", number) : "";
}

}  // namespace

std::size_t Table::column(std::string_view column_name) const {
  const auto found = std::ranges::find(columns, column_name);
  if (found == columns.end())
    throw std::out_of_range(fmt::format("table {} has no column {}", name, column_name));
  return static_cast<std::size_t>(found - columns.begin());
}

double Table::number(std::size_t row, std::string_view column_name) const {
  return std::get<double>(rows.at(row).at(column(column_name)));
}

const std::string& Table::word(std::size_t row, std::string_view column_name) const {
  return std::get<std::string>(rows.at(row).at(column(column_name)));
}

bool matches(const Table& table, std::size_t row, const Filter& filter) {
  return std::ranges::all_of(filter, [&](const auto& wanted) {
    return table.rows.at(row).at(table.column(wanted.first)) == wanted.second;
  });
}

double findNumber(const Table& table, std::string_view column_name, const Filter& filter) {
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (matches(table, row, filter)) return table.number(row, column_name);
  }
  throw std::out_of_range(fmt::format("table {} has no such row", table.name));
}

std::vector<std::array<double, 2>> findPoints(const Table& table, std::string_view x_column,
                                              std::string_view y_column, const Filter& filter) {
  std::vector<std::array<double, 2>> points;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (matches(table, row, filter))
      points.push_back({table.number(row, x_column), table.number(row, y_column)});
  }
  return points;
}

std::string csvText(const Table& table) {
  std::string text;
  const auto addLine = [&text](const auto& cells, const auto& toText) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) text += ',';
      text += toText(cells[i]);
    }
    text += '\n';
  };
  addLine(table.columns, quoted);
  for (const std::vector<Cell>& row : table.rows) addLine(row, cellText);
  return text;
}

Json tableJson(const Table& table) {
  Json json = Json::array();
  for (const std::vector<Cell>& row : table.rows) {
    Json& row_json = json.emplace_back(Json::object());
    for (std::size_t i = 0; i < row.size(); ++i)
      std::visit([&](const auto& value) { row_json[table.columns.at(i)] = value; }, row[i]);
  }
  return json;
}

}  // namespace tactus
