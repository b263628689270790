#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/scene/json.h"
#include "tactus/scene/key_docs.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

struct KeysOptions {
  std::vector<std::string> paths;  ///< or symbols
  std::string manual, schema;
  bool json = false;
};

/// The rows of one file that were asked for.
struct Selection {
  FileFormat format;
  std::vector<KeyRow> rows;
};

[[noreturn]] void failUnknown(const std::string& path) {
  std::vector<std::string> known;
  for (const FileFormat& format : fileFormats()) {
    for (const KeyRow& row : keyRows(format.keys)) {
      known.push_back(row.spec->key);
      if (!row.spec->symbol.empty()) known.push_back(row.spec->symbol);
    }
  }
  const std::string nearest = nearestWord(path.substr(path.rfind('.') + 1), known);
  failAt(beginOf("KEY"), path, "no such key",
         nearest.empty() ? "expected a key of a scene or of a robot"
                         : "expected perhaps " + inQuotes(nearest));
}

/// The rows of a file that a path means; as --set has them, those of a robot may begin with
/// "robot.".
std::vector<KeyRow> rowsOf(const FileFormat& format, const std::string& path) {
  constexpr std::string_view kRobot = "robot.";
  if (!path.starts_with(kRobot)) return findKeyRows(format.keys, path);
  if (format.name != "robot") return {};
  return findKeyRows(format.keys, path.substr(kRobot.size()));
}

/// The rows of a file that any of the paths means, each once, in the order of the paths.
std::vector<KeyRow> selectRows(const FileFormat& format, const std::vector<std::string>& paths) {
  if (paths.empty()) return keyRows(format.keys);
  std::vector<KeyRow> rows;
  for (const std::string& path : paths) {
    for (KeyRow& row : rowsOf(format, path)) {
      if (std::ranges::count(rows, row.spec, &KeyRow::spec) == 0) rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::vector<Selection> select(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    const auto knows = [&](const FileFormat& format) { return !rowsOf(format, path).empty(); };
    if (std::ranges::none_of(fileFormats(), knows)) failUnknown(path);
  }
  std::vector<Selection> selections;
  for (const FileFormat& format : fileFormats()) {
    std::vector<KeyRow> rows = selectRows(format, paths);
    if (!rows.empty()) selections.push_back({format, std::move(rows)});
  }
  return selections;
}

const char* typeName(ValueType type) {
  switch (type) {
    case ValueType::kNumber:
      return "number";
    case ValueType::kInteger:
      return "integer";
    case ValueType::kBoolean:
      return "boolean";
    case ValueType::kText:
      return "text";
    case ValueType::kChoice:
      return "choice";
    case ValueType::kChoiceList:
      return "choice list";
    case ValueType::kNumberList:
      return "number list";
    case ValueType::kNumberTable:
      return "number table";
    case ValueType::kSection:
      return "section";
    case ValueType::kSectionList:
      return "section list";
  }
  return "";
}

const char* presenceName(Presence presence) {
  switch (presence) {
    case Presence::kRequired:
      return "required";
    case Presence::kOptional:
      return "optional";
    case Presence::kDefaulted:
      return "defaulted";
  }
  return "";
}

Json textOrNull(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json rowJson(const FileFormat& format, const KeyRow& row) {
  const KeySpec& spec = *row.spec;
  return {{"file", format.name},
          {"key", row.path},
          {"type", typeName(spec.type)},
          {"unit", textOrNull(spec.unit)},
          {"lower", spec.range.lower},  // null: none
          {"is_lower_open", spec.range.lower_open},
          {"upper", spec.range.upper},
          {"min_count", spec.count.min},
          {"max_count", spec.count.max},
          {"is_one_a_joint", spec.count.one_a_joint},
          {"columns", spec.columns},
          {"choices", spec.choices},
          {"presence", presenceName(spec.presence)},
          {"default", textOrNull(spec.default_value)},
          {"symbol", textOrNull(spec.symbol)},
          {"meaning", spec.doc}};
}

Json toJson(const std::vector<Selection>& selections) {
  Json json = Json::array();
  for (const Selection& selection : selections) {
    for (const KeyRow& row : selection.rows) json.push_back(rowJson(selection.format, row));
  }
  return json;
}

std::string toText(const std::vector<Selection>& selections) {
  std::string text;
  for (const Selection& selection : selections) {
    text += fmt::format("{}{}, see tactus-{}(5)\n", text.empty() ? "" : "\n", selection.format.name,
                        selection.format.name);
    for (const KeyRow& row : selection.rows)
      text +=
          fmt::format("  {}\n      {}\n      {}\n", row.path, keyFacts(*row.spec), row.spec->doc);
  }
  return text;
}

FileFormat formatOf(const std::string& name) {
  const auto formats = fileFormats();
  return formats[0].name == name ? formats[0] : formats[1];
}

std::string describe(const KeysOptions& options) {
  if (!options.manual.empty()) return manualPage(formatOf(options.manual));
  if (!options.schema.empty()) return jsonSchema(formatOf(options.schema));
  const std::vector<Selection> selections = select(options.paths);
  return options.json ? jsonText(toJson(selections)) : toText(selections);
}

}  // namespace

void addKeysCommand(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("keys", "Explain the keys of scenes and robots, all or some");
  const auto options = std::make_shared<KeysOptions>();
  command->add_option(
      "KEY", options->paths,
      "Keys, sections or symbols of the paper: damping, simulation.obstacles, robot.limits, F_act");
  command->add_flag("--json", options->json, "Print JSON");
  const CLI::IsMember formats({"scene", "robot"});
  command->add_option("--man", options->manual, "Print the manual page of a file's format")
      ->check(formats);
  command->add_option("--schema", options->schema, "Print the JSON schema of a file's format")
      ->check(formats)
      ->excludes("--man");
  command->callback([options, &exit_code] {
    std::fputs(describe(*options).c_str(), stdout);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
