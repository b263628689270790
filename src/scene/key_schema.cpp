#include <cstdlib>

#include "tactus/scene/json.h"
#include "tactus/scene/key_docs.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

using Keys = std::vector<KeySpec>;

/// Whether required keys have to be there: not in a scene that may have them from its base.
enum class Completeness { kPartial, kComplete };

void writeWords(JsonWriter& json, const std::vector<std::string>& words, bool or_null = false) {
  json.beginArray();
  for (const std::string& word : words) json.value(word);
  if (or_null) json.null();
  json.endArray();
}

/// Type and, where `key: null` says that the key is absent, null.
void writeType(JsonWriter& json, const char* type, bool or_null) {
  json.key("type");
  or_null ? writeWords(json, {type, "null"}) : json.value(type);
}

void writeRange(JsonWriter& json, const Range& range) {
  json.key(range.lower_open ? "exclusiveMinimum" : "minimum").value(range.lower);
  json.key("maximum").value(range.upper);
}

void writeCount(JsonWriter& json, int min, int max) {
  json.key("minItems").value(min);
  json.key("maxItems").value(max);
}

void writeNumbers(JsonWriter& json, const Range& range) {
  json.key("items").beginObject();
  writeType(json, "number", false);
  writeRange(json, range);
  json.endObject();
}

/// A default as the table holds it, in YAML.
void writeYaml(JsonWriter& json, const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kList) {
    json.beginArray();
    for (const YamlNode& item : node.items) writeYaml(json, item);
    json.endArray();
    return;
  }
  const std::string& text = node.text;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);  // 0x100, too
  if (end == text.c_str() + text.size()) {
    json.value(number);
  } else if (text == "true" || text == "false") {
    json.value(text == "true");
  } else {
    json.value(text);
  }
}

void writeSection(JsonWriter& json, const Keys& keys, Completeness completeness);

void writeChoices(JsonWriter& json, const std::vector<std::string>& choices, bool or_null) {
  json.key("enum");
  writeWords(json, choices, or_null);
}

/// What an entry of a list may be.
void writeItems(JsonWriter& json, const KeySpec& spec) {
  json.key("items").beginObject();
  if (spec.type == ValueType::kChoiceList) {
    writeChoices(json, spec.choices, false);
  } else if (spec.type == ValueType::kNumberTable) {
    writeType(json, "array", false);
    writeCount(json, spec.columns, spec.columns);
    writeNumbers(json, spec.range);
  } else {  // sections: no list is merged with that of a base
    writeType(json, "object", false);
    writeSection(json, spec.keys, Completeness::kComplete);
  }
  json.endObject();
}

void writeList(JsonWriter& json, const KeySpec& spec) {
  writeCount(json, spec.count.min, spec.count.max);
  if (spec.type == ValueType::kChoiceList) json.key("uniqueItems").value(true);
  spec.type == ValueType::kNumberList ? writeNumbers(json, spec.range) : writeItems(json, spec);
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

void writeKey(JsonWriter& json, const KeySpec& spec, Completeness completeness) {
  const bool or_null =
      spec.presence != Presence::kRequired || completeness == Completeness::kPartial;
  json.beginObject();
  json.key("description").value(spec.doc + (spec.unit.empty() ? "" : " [" + spec.unit + "]"));
  writeType(json, schemaType(spec.type), or_null);
  if (spec.type == ValueType::kNumber || spec.type == ValueType::kInteger) {
    writeRange(json, spec.range);
  } else if (spec.type == ValueType::kText) {
    json.key("minLength").value(1);
  } else if (spec.type == ValueType::kChoice) {
    writeChoices(json, spec.choices, or_null);
  } else if (spec.type == ValueType::kSection) {
    writeSection(json, spec.keys, completeness);
  } else if (spec.type != ValueType::kBoolean) {
    writeList(json, spec);
  }
  if (!spec.default_value.empty()) {
    json.key("default");
    writeYaml(json, parseYaml({"the default", spec.default_value}));
  }
  json.endObject();
}

void writeRequired(JsonWriter& json, const Keys& keys) {
  std::vector<std::string> required;
  for (const KeySpec& spec : keys) {
    if (spec.presence == Presence::kRequired) required.push_back(spec.key);
  }
  if (required.empty()) return;
  json.key("required");
  writeWords(json, required);
}

void writeSection(JsonWriter& json, const Keys& keys, Completeness completeness) {
  json.key("properties").beginObject();
  for (const KeySpec& spec : keys) {
    json.key(spec.key);
    writeKey(json, spec, completeness);
  }
  json.endObject();
  json.key("additionalProperties").value(false);
  if (completeness == Completeness::kComplete) writeRequired(json, keys);
}

/// Of a file that may be partial and is not: its required keys, all the way down.
void writeAllRequired(JsonWriter& json, const Keys& keys) {
  writeRequired(json, keys);
  json.key("properties").beginObject();
  for (const KeySpec& spec : keys) {
    json.key(spec.key).beginObject();
    if (spec.presence == Presence::kRequired) {
      json.key("not").beginObject();
      writeType(json, "null", false);
      json.endObject();
    }
    if (spec.type == ValueType::kSection) writeAllRequired(json, spec.keys);
    json.endObject();
  }
  json.endObject();
}

/// A file that extends another may have its required keys from there.
void writeUnlessExtending(JsonWriter& json, const Keys& keys) {
  json.key("if").beginObject();
  json.key("required");
  writeWords(json, {"extends"});
  json.key("properties").beginObject();
  json.key("extends").beginObject();
  writeType(json, "string", false);
  json.endObject();
  json.endObject();
  json.endObject();
  json.key("else").beginObject();
  writeAllRequired(json, keys);
  json.endObject();
}

}  // namespace

std::string jsonSchema(const FileFormat& format) {
  const bool may_extend = format.keys.front().key == "extends";
  JsonWriter json;
  json.beginObject();
  json.key("$schema").value("https://json-schema.org/draft/2020-12/schema");
  json.key("title").value("Tactus " + std::string(format.name));
  writeType(json, "object", false);
  writeSection(json, format.keys, may_extend ? Completeness::kPartial : Completeness::kComplete);
  if (may_extend) writeUnlessExtending(json, format.keys);
  json.endObject();
  return json.text();
}

}  // namespace tactus
