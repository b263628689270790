#pragma once

#include "tactus/scene/key_table.h"

/// Short spellings for the rows of the key tables.
namespace tactus::keys {

inline constexpr double kMaxTime_s = 86400.0;
inline constexpr double kMaxStiffness_N_per_m = 1e9;

inline Range above(double lower, double upper) { return {lower, upper, true}; }
inline Range within(double lower, double upper) { return {lower, upper, false}; }

inline KeySpec required(KeySpec spec) {
  spec.presence = Presence::kRequired;
  return spec;
}
inline KeySpec optional(KeySpec spec) {
  spec.presence = Presence::kOptional;
  return spec;
}
inline KeySpec defaulted(std::string value, KeySpec spec) {
  spec.presence = Presence::kDefaulted;
  spec.default_value = std::move(value);
  return spec;
}

inline KeySpec value(ValueType type, std::string key, std::string unit, std::string doc,
                     Target target) {
  KeySpec spec;
  spec.key = std::move(key);
  spec.type = type;
  spec.unit = std::move(unit);
  spec.doc = std::move(doc);
  spec.target = target;
  return spec;
}

inline KeySpec number(std::string key, std::string unit, Range range, std::string doc,
                      double& (*target)(ConfigDraft&)) {
  KeySpec spec = value(ValueType::kNumber, std::move(key), std::move(unit), std::move(doc), target);
  spec.range = range;
  return spec;
}

inline KeySpec integer(std::string key, Range range, std::string doc, Target target) {
  KeySpec spec = value(ValueType::kInteger, std::move(key), "", std::move(doc), target);
  spec.range = range;
  return spec;
}

inline KeySpec boolean(std::string key, std::string doc, bool& (*target)(ConfigDraft&)) {
  return value(ValueType::kBoolean, std::move(key), "", std::move(doc), target);
}

inline KeySpec text(std::string key, std::string doc, std::string& (*target)(ConfigDraft&)) {
  return value(ValueType::kText, std::move(key), "", std::move(doc), target);
}

inline KeySpec vector3(std::string key, std::string unit, Range range, std::string doc,
                       Vector3& (*target)(ConfigDraft&)) {
  KeySpec spec =
      value(ValueType::kNumberList, std::move(key), std::move(unit), std::move(doc), target);
  spec.range = range;
  spec.count = {3, 3};
  return spec;
}

inline KeySpec oneAJoint(std::string key, std::string unit, Range range, std::string doc,
                         std::vector<double>& (*target)(ConfigDraft&)) {
  KeySpec spec =
      value(ValueType::kNumberList, std::move(key), std::move(unit), std::move(doc), target);
  spec.range = range;
  spec.count = {2, kMaxJoints, true};
  return spec;
}

inline KeySpec section(std::string key, std::string doc, std::vector<KeySpec> rows,
                       void (*begin)(ConfigDraft&) = nullptr) {
  KeySpec spec = value(ValueType::kSection, std::move(key), "", std::move(doc), {});
  spec.keys = std::move(rows);
  spec.begin = begin;
  return spec;
}

/// `begin` appends an entry, which the rows then fill.
inline KeySpec sectionList(std::string key, Count count, std::string doc, std::vector<KeySpec> rows,
                           void (*begin)(ConfigDraft&)) {
  KeySpec spec = section(std::move(key), std::move(doc), std::move(rows), begin);
  spec.type = ValueType::kSectionList;
  spec.count = count;
  return spec;
}

}  // namespace tactus::keys
