#include "tactus/bench/report_page.h"

#include <nlohmann/json.hpp>

#include "tactus/bench/child_program.h"

namespace tactus {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Series& series) {
  Json where = Json::object();
  for (const auto& [column, cell] : series.filter)
    std::visit([&where, &name = column](const auto& value) { where[name] = value; }, cell);
  return {{"label", series.label}, {"where", where}};
}

Json toJson(const Plot& plot) {
  const auto scale = [](Scale s) { return s == Scale::kLinear ? "linear" : "log"; };
  Json json = {{"title", plot.title},
               {"note", plot.note},
               {"table", plot.table},
               {"x", plot.x_column},
               {"y", plot.y_column},
               {"x_label", plot.x_label},
               {"y_label", plot.y_label},
               {"x_scale", scale(plot.x_scale)},
               {"y_scale", scale(plot.y_scale)},
               {"has_lines", plot.has_lines},
               {"series", Json::array()}};
  for (const Series& series : plot.series) json["series"].push_back(toJson(series));
  return json;
}

Json toJson(const StudyResult& result) {
  Json json = {{"title", result.title},
               {"text", result.text},
               {"plots", Json::array()},
               {"tables", Json::array()}};
  for (const Plot& plot : result.plots) json["plots"].push_back(toJson(plot));
  for (const Table& table : result.tables) json["tables"].push_back(table.name);
  return json;
}

/// Of a Python error the one that says what it is.
std::string lastLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

}  // namespace

std::string reportJson(const std::vector<StudyResult>& results) {
  Json sections = Json::array();
  for (const StudyResult& result : results) sections.push_back(toJson(result));
  const Json json = {{"sections", sections}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string makeReportPage(const std::filesystem::path& program,
                           const std::filesystem::path& folder) {
  const ChildResult result =
      runProgram({program.string(), std::filesystem::absolute(folder).string()});
  if (result.exit_code == 0) return "";
  if (!result.errors.empty()) return lastLine(result.errors);
  return program.string() + ": cannot be run, expected it beside tactus-bench, and python3";
}

}  // namespace tactus
