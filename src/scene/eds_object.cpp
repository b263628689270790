#include "tactus/scene/eds_object.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace tactus {
namespace {

constexpr int kVariable = 7, kArray = 8, kRecord = 9;  // ObjectType
constexpr int kMaxSubindex = 254;
constexpr int kMaxPdos = 512;  // CiA 301, 7.5.2.35 and 7.5.2.37

[[noreturn]] void refuseEntry(const SourcePosition& at, const std::string& section, const char* key,
                              const std::string& problem, const std::string& expectation) {
  failAt(at, section + "." + key, problem, "expected " + expectation);
}

/// A whole number of a key; nothing where the key is missing or empty.
std::optional<std::int64_t> wholeNumber(const EdsSection& section, const char* key,
                                        const char* expectation) {
  const EdsValue* const value = section.find(key);
  if (!value || value->text.empty()) return std::nullopt;
  const auto number = parseEdsNumber(value->text);
  if (!number || number->plus_node_id)
    refuseEntry(value->at, section.name, key, inQuotes(value->text) + " is no number", expectation);
  return number->value;
}

std::int64_t objectType(const EdsSection& section) {
  const auto type = wholeNumber(section, "ObjectType", "0x7, 0x8 or 0x9");
  return type.value_or(section.find("SubNumber") || section.find("CompactSubObj") ? kRecord
                                                                                  : kVariable);
}

/// The section of an object. It and the lists have to agree whether the object is there.
const EdsSection* sectionOf(const EdsFile& eds, std::uint16_t index) {
  const EdsSection* const section = eds.find(fmt::format("{:x}", index));
  const auto listed = eds.objects.find(index);
  if (section && listed == eds.objects.end()) {
    failAt(section->at, section->name, "the object is in no list of objects",
           "expected it in MandatoryObjects, OptionalObjects or ManufacturerObjects");
  }
  if (!section && listed != eds.objects.end()) {
    failAt(listed->second, edsName(index, 0), "the object is listed and has no section",
           fmt::format("expected [{:04X}], or a file that is whole", index));
  }
  return section;
}

/// Sections of sub-entries are as many as SubNumber says.
void checkSubNumber(const EdsFile& eds, const EdsSection& section, std::uint16_t index) {
  const auto said = wholeNumber(section, "SubNumber", "the number of sub-entries");
  if (!said) return;
  std::int64_t found = 0;
  for (int sub = 0; sub <= kMaxSubindex + 1; ++sub)
    if (eds.find(fmt::format("{:x}sub{:x}", index, sub))) ++found;
  if (*said == found) return;
  refuseEntry(section.find("SubNumber")->at, section.name, "SubNumber",
              fmt::format("{} is not the number of its sections", *said),
              fmt::format("{}, or a file that is whole", found));
}

EdsType dataTypeOf(const EdsSection& section) {
  static constexpr std::array<std::pair<int, EdsType>, 9> kTypes = {{{1, {1, false}},
                                                                     {2, {1, true}},
                                                                     {3, {2, true}},
                                                                     {4, {4, true}},
                                                                     {5, {1, false}},
                                                                     {6, {2, false}},
                                                                     {7, {4, false}},
                                                                     {0x15, {8, true}},
                                                                     {0x1B, {8, false}}}};
  constexpr const char* kExpectation = "a type of whole numbers, as 0x0007";
  const auto code = wholeNumber(section, "DataType", kExpectation);
  if (!code) refuseEntry(section.at, section.name, "DataType", "is missing", kExpectation);
  for (const auto& [known, type] : kTypes)
    if (known == *code) return type;
  refuseEntry(section.find("DataType")->at, section.name, "DataType",
              fmt::format("{:#06x} is no whole number", *code), kExpectation);
}

EdsAccess accessOf(const EdsSection& section) {
  static constexpr std::array<std::pair<const char*, EdsAccess>, 6> kWords = {
      {{"const", EdsAccess::kConstant},
       {"ro", EdsAccess::kReadOnly},
       {"wo", EdsAccess::kWriteOnly},
       {"rw", EdsAccess::kReadWrite},
       {"rwr", EdsAccess::kReadInput},
       {"rww", EdsAccess::kWriteOutput}}};
  constexpr const char* kExpectation = "ro, wo, rw, rwr, rww or const";
  const EdsValue* const value = section.find("AccessType");
  if (!value) refuseEntry(section.at, section.name, "AccessType", "is missing", kExpectation);
  for (const auto& [word, access] : kWords)
    if (edsSectionKey(value->text) == word) return access;
  refuseEntry(value->at, section.name, "AccessType", inQuotes(value->text) + " is none",
              kExpectation);
}

SourcePosition placeOfKey(const EdsSection& section, const char* key) {
  const EdsValue* const value = section.find(key);
  return value ? value->at : section.at;
}

std::optional<EdsNumber> numberOf(const EdsSection& section, const char* key) {
  const EdsValue* const value = section.find(key);
  if (!value || value->text.empty()) return std::nullopt;
  const auto number = parseEdsNumber(value->text);
  if (!number)
    refuseEntry(value->at, section.name, key, inQuotes(value->text) + " is no number",
                "a whole number, or nothing");
  return number;
}

/// Limits leave values between them, of which the default value is one. Sheets say 0 where they
/// say nothing.
void checkRange(const EdsObject& object, const std::string& section) {
  const auto lowest = object.ofEachNode(object.lowest);
  const auto highest = object.ofEachNode(object.highest);
  const auto initial = object.ofEachNode(object.initial);
  if (lowest && highest && *lowest > *highest)
    refuseEntry(object.lowest_at, section, "LowLimit",
                fmt::format("{} is above HighLimit = {}", *lowest, *highest), "at most that");
  if (!initial || *initial == 0) return;
  if (lowest && *initial < *lowest)
    refuseEntry(object.initial_at, section, "DefaultValue",
                fmt::format("{} is below LowLimit = {}", *initial, *lowest), "at least that");
  if (highest && *initial > *highest)
    refuseEntry(object.initial_at, section, "DefaultValue",
                fmt::format("{} is above HighLimit = {}", *initial, *highest), "at most that");
}

EdsObject describedBy(const EdsSection& section, std::string name) {
  const auto mapping = wholeNumber(section, "PDOMapping", "0 or 1");
  EdsObject object{.name = std::move(name),
                   .at = section.at,
                   .type = dataTypeOf(section),
                   .type_at = placeOfKey(section, "DataType"),
                   .access = accessOf(section),
                   .access_at = placeOfKey(section, "AccessType"),
                   .is_mappable = mapping.value_or(0) != 0,
                   .mapping_at = placeOfKey(section, "PDOMapping"),
                   .initial = numberOf(section, "DefaultValue"),
                   .lowest = numberOf(section, "LowLimit"),
                   .highest = numberOf(section, "HighLimit"),
                   .initial_at = placeOfKey(section, "DefaultValue"),
                   .lowest_at = placeOfKey(section, "LowLimit"),
                   .highest_at = placeOfKey(section, "HighLimit")};
  checkRange(object, section.name);
  return object;
}

/// Sub-entries without sections (CompactSubObj): all alike, behind their number.
std::optional<EdsObject> compactEntry(const EdsSection& section, std::int64_t entries,
                                      std::uint8_t subindex, const std::string& name) {
  if (subindex > entries) return std::nullopt;
  EdsObject object = describedBy(section, name);
  if (subindex > 0) return object;
  object.type = {1, false};
  object.access = EdsAccess::kReadOnly;
  object.is_mappable = false;
  object.initial = EdsNumber{entries, false};
  object.lowest = object.highest = std::nullopt;
  return object;
}

}  // namespace

std::int64_t EdsObject::inType(std::int64_t value) const noexcept {
  if (!type.is_signed || type.bytes >= 8) return value;
  const std::int64_t range = std::int64_t{1} << 8 * type.bytes;
  return value >= range / 2 && value < range ? value - range : value;
}

int edsPdos(const EdsFile& eds, std::uint16_t first, int least) {
  int pdos = least;
  for (int pdo = least; pdo < kMaxPdos; ++pdo)
    if (eds.objects.contains(first + pdo) || eds.find(fmt::format("{:x}", first + pdo)))
      pdos = pdo + 1;
  return pdos;
}

std::optional<std::int64_t> EdsObject::ofEachNode(
    const std::optional<EdsNumber>& number) const noexcept {
  if (!number || number->plus_node_id) return std::nullopt;
  return inType(number->value);
}

std::string edsName(std::uint16_t index, std::uint8_t subindex) {
  return subindex == 0 ? fmt::format("{:04X}", index)
                       : fmt::format("{:04X}sub{:X}", index, subindex);
}

std::optional<EdsObject> findEdsObject(const EdsFile& eds, std::uint16_t index,
                                       std::uint8_t subindex) {
  const EdsSection* const section = sectionOf(eds, index);
  if (!section) return std::nullopt;
  const std::int64_t type = objectType(*section);
  if (type == kVariable) {
    if (subindex > 0) return std::nullopt;
    return describedBy(*section, edsName(index, 0));
  }
  if (type != kArray && type != kRecord)
    refuseEntry(section->find("ObjectType")->at, section->name, "ObjectType",
                fmt::format("{:#x} has no number to be read or written", type), "0x7, 0x8 or 0x9");
  const std::string name = fmt::format("{:04X}sub{:X}", index, subindex);
  const EdsSection* const entry = eds.find(name);
  const auto compact = wholeNumber(*section, "CompactSubObj", "the number of sub-entries");
  if (compact.value_or(0) > 0 && !entry) return compactEntry(*section, *compact, subindex, name);
  if (compact.value_or(0) == 0) checkSubNumber(eds, *section, index);
  if (!entry) return std::nullopt;
  return describedBy(*entry, name);
}

}  // namespace tactus
