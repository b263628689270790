#include <fmt/format.h>

#include <cmath>

#include "tactus/bench/study.h"

namespace tactus {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ink: #1d2430; --paper: #fdfdfc; --faint: #5d6675;
  --grid: #d9dce1; --c0: #2563c9; --c1: #c8352b; --c2: #157f43; --c3: #c96a00; --c4: #7d3fc0;
  --c5: #0f7f8c; --c6: #b0307e; --c7: #6b6b1e; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e7ec; --paper: #14181f; --faint: #a0a9b8;
  --grid: #333a46; --c0: #82aeff; --c1: #ff8277; --c2: #52c98a; --c3: #f2a93b; --c4: #c49bff;
  --c5: #5fd0dd; --c6: #ff86cc; --c7: #cfcf5c; } }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
main { max-width: 58rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.2rem; margin: 2.75rem 0 .75rem; }
figure { margin: 0 0 2.5rem; } svg { display: block; width: 100%; height: auto; }
svg text { font-size: 11px; fill: var(--ink); } svg .grid { stroke: var(--grid); fill: none; }
figcaption { font-size: .92rem; color: var(--faint); } figcaption b { color: var(--ink); }
.series { fill: var(--c); } .series .line { fill: none; stroke: var(--c); stroke-width: 1.5; }
.c0 { --c: var(--c0); } .c1 { --c: var(--c1); } .c2 { --c: var(--c2); } .c3 { --c: var(--c3); }
.c4 { --c: var(--c4); } .c5 { --c: var(--c5); } .c6 { --c: var(--c6); } .c7 { --c: var(--c7); }
.wide { overflow: auto; max-height: 30rem; }
table { border-collapse: collapse; font-size: .85rem; }
th, td { padding: .3rem .8rem .3rem 0; text-align: left; font-variant-numeric: tabular-nums; }
thead th { border-bottom: 1.5px solid var(--ink); } tbody tr { border-bottom: 1px solid var(--grid); }
summary { cursor: pointer; color: var(--faint); }
)";

std::string shortText(const Cell& cell) {
  if (const std::string* word = std::get_if<std::string>(&cell)) return escapeHtml(*word);
  const double number = std::get<double>(cell);
  return std::isfinite(number) ? fmt::format("{:.4g}", number) : "";
}

std::string tableText(const Table& table) {
  std::string text = "<div class=\"wide\"><table><thead><tr>";
  for (const std::string& column : table.columns)
    text += fmt::format("<th scope=\"col\">{}</th>", escapeHtml(column));
  text += "</tr></thead>\n<tbody>\n";
  for (const std::vector<Cell>& row : table.rows) {
    text += "<tr>";
    for (const Cell& cell : row) text += fmt::format("<td>{}</td>", shortText(cell));
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

std::string sectionText(const StudyResult& result) {
  std::string text =
      fmt::format("<h2>{}</h2>\n<p>{}</p>\n", escapeHtml(result.title), escapeHtml(result.text));
  for (const Plot& plot : result.plots) {
    text += fmt::format("<figure>\n{}<figcaption><b>{}</b> {}</figcaption></figure>\n",
                        svgText(plot), escapeHtml(plot.title), escapeHtml(plot.note));
  }
  for (const Table& table : result.tables) {
    text += fmt::format("<details><summary>{}.csv</summary>\n{}</details>\n",
                        escapeHtml(table.name), tableText(table));
  }
  return text;
}

}  // namespace

std::string reportPage(const std::vector<StudyResult>& results) {
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Tactus: error against run time</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n"
      "<h1>Error against run time</h1>\n",
      kStyle);
  const Table goals = goalTable(results);
  if (!goals.rows.empty()) text += "<h2>Goals</h2>\n" + tableText(goals);
  for (const StudyResult& result : results) text += sectionText(result);
  return text + "</main>\n</body>\n</html>\n";
}

}  // namespace tactus
