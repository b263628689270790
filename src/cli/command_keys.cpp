#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
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
  failAt({std::make_shared<std::string>("KEY"), 1, 1}, path, "no such key",
         nearest.empty() ? "expected a key of a scene or of a robot"
                         : "expected perhaps " + inQuotes(nearest));
}

/// The rows of a file that any of the paths means, each once, in the order of the paths.
std::vector<KeyRow> selectRows(const FileFormat& format, const std::vector<std::string>& paths) {
  if (paths.empty()) return keyRows(format.keys);
  std::vector<KeyRow> rows;
  for (const std::string& path : paths) {
    for (KeyRow& row : findKeyRows(format.keys, path)) {
      if (std::ranges::count(rows, row.spec, &KeyRow::spec) == 0) rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::vector<Selection> select(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    const auto knows = [&](const FileFormat& format) {
      return !findKeyRows(format.keys, path).empty();
    };
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

void writeRow(JsonWriter& json, const FileFormat& format, const KeyRow& row) {
  const KeySpec& spec = *row.spec;
  const auto textOrNull = [&json](const char* key, const std::string& text) {
    json.key(key);
    text.empty() ? json.null() : json.value(text);
  };
  json.beginObject();
  json.key("file").value(format.name);
  json.key("key").value(row.path);
  json.key("type").value(typeName(spec.type));
  textOrNull("unit", spec.unit);
  json.key("lower").value(spec.range.lower);  // null: none
  json.key("is_lower_open").value(spec.range.lower_open);
  json.key("upper").value(spec.range.upper);
  json.key("min_count").value(spec.count.min);
  json.key("max_count").value(spec.count.max);
  json.key("is_one_a_joint").value(spec.count.one_a_joint);
  json.key("columns").value(spec.columns);
  json.key("choices").beginArray();
  for (const std::string& choice : spec.choices) json.value(choice);
  json.endArray();
  json.key("presence").value(presenceName(spec.presence));
  textOrNull("default", spec.default_value);
  textOrNull("symbol", spec.symbol);
  json.key("meaning").value(spec.doc);
  json.endObject();
}

std::string toJson(const std::vector<Selection>& selections) {
  JsonWriter json;
  json.beginArray();
  for (const Selection& selection : selections) {
    for (const KeyRow& row : selection.rows) writeRow(json, selection.format, row);
  }
  json.endArray();
  return json.text();
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
  return options.json ? toJson(selections) : toText(selections);
}

}  // namespace

void addKeysCommand(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("keys", "Explain the keys of scenes and robots, all or some");
  const auto options = std::make_shared<KeysOptions>();
  command->add_option(
      "KEY", options->paths,
      "Keys, sections or symbols of the paper: damping, simulation.obstacles, F_act");
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
