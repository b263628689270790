#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/located_error.h"
#include "tactus/scene/scene.h"

/// Electronic data sheets of CANopen devices (CiA 306-1): an INI file whose sections describe the
/// device and each entry of its object dictionary. Names of sections and keys in any case.
namespace tactus {

/// A number as data sheets write it: decimal, hexadecimal (0x), octal (0), with or without the
/// device's node id on top ($NODEID+0x180).
struct EdsNumber {
  std::int64_t value = 0;
  bool plus_node_id = false;

  bool operator==(const EdsNumber&) const = default;
};

/// Nothing for text that is none, or that takes more than 64 bits.
std::optional<EdsNumber> parseEdsNumber(std::string_view text) noexcept;

struct EdsValue {
  std::string text;   ///< without white space around it and a comment behind it; may be empty
  SourcePosition at;  ///< of the line's key
};

struct EdsSection {
  std::string name;  ///< as written
  SourcePosition at;
  std::map<std::string, EdsValue> values;  ///< by key in lower case

  const EdsValue* find(std::string_view key) const;
};

/// The name under which a section is found: lower case, and of an object without leading zeros:
/// "1018sub1" of [1018SUB01].
std::string edsSectionKey(std::string_view name);

/// The sections that list the objects.
inline constexpr std::array<const char*, 3> kEdsObjectLists = {
    "MandatoryObjects", "OptionalObjects", "ManufacturerObjects"};

struct EdsFile {
  SourcePosition begin;
  std::map<std::string, EdsSection> sections;      ///< by edsSectionKey()
  std::map<std::int64_t, SourcePosition> objects;  ///< that the lists name, and where

  const EdsSection* find(std::string_view key) const;
};

/// Throws InputError at the first line that is no INI, a section or a key that comes twice, and a
/// list of objects that says another number of them than it has, or one twice.
EdsFile parseEds(const SourceFile& file);

}  // namespace tactus
