#include "tactus/record/trigger_condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr std::size_t kMostCharacters = 200;
constexpr std::string_view kForm = "expected FIELD COMPARISON NUMBER, as force_N[0] > 1.2";

/// Reads an expression from left to right, and knows where it is.
class TriggerReader {
 public:
  explicit TriggerReader(const std::string& text) : text_(text) {}

  [[noreturn]] void fail(std::size_t at, std::string_view problem,
                         std::string_view expectation) const {
    const SourcePosition place{std::make_shared<std::string>("--trigger"), 1,
                               static_cast<int>(at) + 1};
    failAt(place, inQuotes(text_), problem, expectation);
  }

  std::size_t skipBlanks() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_;
  }

  template <typename IsPart>
  std::string_view take(IsPart is_part) {
    const std::size_t from = at_;
    while (at_ < text_.size() && is_part(text_[at_])) ++at_;
    return std::string_view(text_).substr(from, at_ - from);
  }

  bool takeIf(char wanted) {
    if (at_ >= text_.size() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }

  std::string found() const {
    return at_ >= text_.size() ? "nothing is left" : "found " + inQuotes(text_.substr(at_, 20));
  }

  template <typename Number>
  bool takeNumber(Number& number) {
    const char* const from = text_.data() + at_;
    const auto [end, error] = std::from_chars(from, text_.data() + text_.size(), number);
    if (error != std::errc()) return false;
    if (!isFinite(number)) return false;
    at_ += static_cast<std::size_t>(end - from);
    return true;
  }

  bool isAtEnd() const { return at_ >= text_.size(); }

 private:
  static bool isFinite(double number) { return std::isfinite(number); }  // "nan" and "inf" are read
  static bool isFinite(std::size_t) { return true; }

  const std::string& text_;
  std::size_t at_ = 0;
};

bool isNamePart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

const RecordField* fieldNamed(std::string_view name, const RecordShape& shape) {
  for (const RecordField& field : recordFields())
    if (field.name == name && shape.entries(field) > 0) return &field;
  return nullptr;
}

[[noreturn]] void refuseName(const TriggerReader& reader, std::size_t at, std::string_view name,
                             const RecordShape& shape) {
  if (name.empty()) reader.fail(at, reader.found(), kForm);
  std::vector<std::string> names{"force_N"};
  for (const RecordField& field : recordFields())
    if (shape.entries(field) > 0) names.emplace_back(field.name);
  const std::string nearest = nearestWord(name, names);
  reader.fail(at, inQuotes(name) + " is no field of the log",
              nearest.empty() ? "expected one that tactus export writes" : "perhaps " + nearest);
}

/// Behind the name of a field, which may be a list.
void takeEntry(TriggerReader& reader, std::size_t at, const RecordField& field,
               const RecordShape& shape, TriggerCondition& condition) {
  const auto column = [&](std::size_t entry) {
    return RecordColumn{field.name, field.name, field.type, field.role,
                        field.offset + entry * sizeof(double)};
  };
  const std::size_t entries = shape.entries(field);
  const bool is_of_module =
      field.shape == FieldShape::kPerModule || field.shape == FieldShape::kOfMomentX;
  if (!reader.takeIf('[')) {
    if (shape.isArray(field) && !is_of_module) {
      reader.fail(at, fmt::format("{} is a list of {}", field.name, entries),
                  fmt::format("expected one of them, as {}[0]", field.name));
    }
    for (std::size_t i = 0; i < entries; ++i) condition.columns.push_back(column(i));
    return;
  }
  const std::size_t index_at = reader.skipBlanks();
  if (!shape.isArray(field) && !is_of_module)
    reader.fail(index_at, fmt::format("{} is no list", field.name), "expected no index");
  std::size_t index = 0;
  if (!reader.takeNumber(index) || index >= entries) {
    reader.fail(index_at, fmt::format("no index of {}", field.name),
                entries == 1 ? "expected 0" : fmt::format("expected 0 to {}", entries - 1));
  }
  reader.skipBlanks();
  const std::size_t bracket_at = reader.skipBlanks();
  if (!reader.takeIf(']')) reader.fail(bracket_at, reader.found(), "expected ]");
  condition.columns.push_back(column(index));
}

void takeField(TriggerReader& reader, const RecordShape& shape, TriggerCondition& condition) {
  const std::size_t at = reader.skipBlanks();
  std::string_view name = reader.take(isNamePart);
  if (name == "force_N") name = "force_sensor_N";
  if (const RecordField* const field = fieldNamed(name, shape)) {
    takeEntry(reader, at, *field, shape, condition);
    condition.unit = field->unit;
    return;
  }
  for (const RecordColumn& column : recordColumns(shape)) {
    if (column.name != name) continue;
    condition.columns.push_back(column);
    condition.unit = fieldNamed(column.field, shape)->unit;
    return;
  }
  refuseName(reader, at, name, shape);
}

Comparison takeComparison(TriggerReader& reader) {
  const std::size_t at = reader.skipBlanks();
  if (reader.takeIf('>')) return reader.takeIf('=') ? Comparison::kAtLeast : Comparison::kAbove;
  if (reader.takeIf('<')) return reader.takeIf('=') ? Comparison::kAtMost : Comparison::kBelow;
  reader.fail(at, reader.found(), "expected one of > >= < <=");
}

}  // namespace

TriggerCondition parseTrigger(const std::string& text, const RecordShape& shape) {
  TriggerReader reader(text);
  if (text.size() > kMostCharacters)
    reader.fail(kMostCharacters, "too long", fmt::format("at most {} bytes", kMostCharacters));
  TriggerCondition condition;
  condition.text = text;
  takeField(reader, shape, condition);
  condition.comparison = takeComparison(reader);
  const std::size_t at = reader.skipBlanks();
  if (!reader.takeNumber(condition.level)) reader.fail(at, reader.found(), "expected a number");
  const std::size_t end = reader.skipBlanks();
  if (!reader.isAtEnd()) reader.fail(end, reader.found(), "expected the end");
  return condition;
}

double signalOf(const TriggerCondition& condition, const CycleRecord& record) noexcept {
  const bool is_rising = condition.isRising();
  double signal = numberAt(record, condition.columns.front());
  for (const RecordColumn& column : condition.columns) {
    const double value = numberAt(record, column);
    if (std::isnan(value)) return value;
    signal = is_rising ? std::max(signal, value) : std::min(signal, value);
  }
  return signal;
}

}  // namespace tactus
