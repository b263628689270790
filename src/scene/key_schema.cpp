#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tactus/scene/json.h"
#include "tactus/scene/key_docs.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

using Keys = std::vector<KeySpec>;

/// Whether required keys have to be there: not in a scene that may have them from its base.
enum class Completeness { kPartial, kComplete };

/// Whole numbers without a fraction, as a reader of integers expects them.
Json numberJson(double number) {
  const bool is_whole = std::abs(number) < 1e15 && number == std::floor(number);
  return is_whole ? Json(static_cast<long long>(number)) : Json(number);
}

/// Type and, where `key: null` says that the key is absent, null.
Json typeJson(const char* type, bool or_null) {
  return or_null ? Json::array({type, "null"}) : Json(type);
}

Json choicesJson(const std::vector<std::string>& choices, bool or_null) {
  Json json = choices;
  if (or_null) json.push_back(nullptr);
  return json;
}

void addRange(const Range& range, Json& schema) {
  schema[range.lower_open ? "exclusiveMinimum" : "minimum"] = numberJson(range.lower);
  schema["maximum"] = numberJson(range.upper);
}

void addCount(int min, int max, Json& schema) {
  schema["minItems"] = min;
  schema["maxItems"] = max;
}

Json numberSchema(const Range& range) {
  Json schema = {{"type", "number"}};
  addRange(range, schema);
  return schema;
}

/// A default as the table holds it, in YAML.
Json yamlJson(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kList) {
    Json list = Json::array();
    for (const YamlNode& item : node.items) list.push_back(yamlJson(item));
    return list;
  }
  const std::string& text = node.text;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);  // 0x100, too
  if (end == text.c_str() + text.size()) return numberJson(number);
  return text == "true" || text == "false" ? Json(text == "true") : Json(text);
}

void addSection(const Keys& keys, Completeness completeness, Json& schema);

/// What an entry of a list may be.
Json itemSchema(const KeySpec& spec) {
  Json schema = Json::object();
  if (spec.type == ValueType::kNumberList) {
    schema = numberSchema(spec.range);
  } else if (spec.type == ValueType::kChoiceList) {
    schema["enum"] = choicesJson(spec.choices, false);
  } else if (spec.type == ValueType::kNumberTable) {
    schema["type"] = "array";
    addCount(spec.columns, spec.columns, schema);
    schema["items"] = numberSchema(spec.range);
  } else {  // sections: no list is merged with that of a base
    schema["type"] = "object";
    addSection(spec.keys, Completeness::kComplete, schema);
  }
  return schema;
}

void addList(const KeySpec& spec, Json& schema) {
  addCount(spec.count.min, spec.count.max, schema);
  if (spec.type == ValueType::kChoiceList) schema["uniqueItems"] = true;
  schema["items"] = itemSchema(spec);
}

const char* schemaType(ValueType type) {
  switch (type) {
    case ValueType::kNumber:
      return "number";
    case ValueType::kInteger:
      return "integer";
    case ValueType::kBoolean:
      return "boolean";
    case ValueType::kText:
    case ValueType::kChoice:
      return "string";
    case ValueType::kSection:
      return "object";
    default:
      return "array";
  }
}

Json keySchema(const KeySpec& spec, Completeness completeness) {
  const bool or_null =
      spec.presence != Presence::kRequired || completeness == Completeness::kPartial;
  Json schema = {{"description", spec.doc + (spec.unit.empty() ? "" : " [" + spec.unit + "]")},
                 {"type", typeJson(schemaType(spec.type), or_null)}};
  if (spec.type == ValueType::kNumber || spec.type == ValueType::kInteger) {
    addRange(spec.range, schema);
  } else if (spec.type == ValueType::kText) {
    schema["minLength"] = 1;
  } else if (spec.type == ValueType::kChoice) {
    schema["enum"] = choicesJson(spec.choices, or_null);
  } else if (spec.type == ValueType::kSection) {
    addSection(spec.keys, completeness, schema);
  } else if (spec.type != ValueType::kBoolean) {
    addList(spec, schema);
  }
  if (!spec.default_value.empty())
    schema["default"] = yamlJson(parseYaml({"the default", spec.default_value}));
  if (spec.context != KeyContext::kRestart) schema["x-context"] = contextName(spec.context);
  return schema;
}

void addRequired(const Keys& keys, Json& schema) {
  std::vector<std::string> required;
  for (const KeySpec& spec : keys) {
    if (spec.presence == Presence::kRequired) required.push_back(spec.key);
  }
  if (!required.empty()) schema["required"] = required;
}

void addNotBoth(const std::string& key, const std::string& other, Json& schema) {
  const Json given = {{"not", {{"type", "null"}}}};
  schema["not"] = {{"required", {key, other}}, {"properties", {{key, given}, {other, given}}}};
}

void addSection(const Keys& keys, Completeness completeness, Json& schema) {
  Json& properties = schema["properties"] = Json::object();
  for (const KeySpec& spec : keys) properties[spec.key] = keySchema(spec, completeness);
  for (const KeySpec& spec : keys) {
    if (!spec.same_as.empty()) addNotBoth(spec.key, spec.same_as, schema);
  }
  schema["additionalProperties"] = false;
  if (completeness == Completeness::kComplete) addRequired(keys, schema);
}

/// Of a file that may be partial and is not: its required keys, all the way down.
void addAllRequired(const Keys& keys, Json& schema) {
  addRequired(keys, schema);
  Json& properties = schema["properties"] = Json::object();
  for (const KeySpec& spec : keys) {
    Json& property = properties[spec.key] = Json::object();
    if (spec.presence == Presence::kRequired) property["not"] = {{"type", "null"}};
    if (spec.type == ValueType::kSection) addAllRequired(spec.keys, property);
  }
}

/// A file that extends another may have its required keys from there.
void addUnlessExtending(const Keys& keys, Json& schema) {
  schema["if"] = {{"required", {"extends"}}, {"properties", {{"extends", {{"type", "string"}}}}}};
  addAllRequired(keys, schema["else"]);
}

}  // namespace

std::string jsonSchema(const FileFormat& format) {
  const bool may_extend = format.keys.front().key == "extends";
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Tactus " + std::string(format.name)},
                 {"type", "object"}};
  addSection(format.keys, may_extend ? Completeness::kPartial : Completeness::kComplete, schema);
  if (may_extend) addUnlessExtending(format.keys, schema);
  return jsonText(schema);
}

}  // namespace tactus
