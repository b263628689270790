#include "tactus/record/csv_writer.h"

#include <array>
#include <charconv>
#include <cstring>

namespace tactus {
namespace {

template <typename Word>
Word wordAt(const CycleRecord& record, std::size_t offset) noexcept {
  Word word;
  std::memcpy(&word, reinterpret_cast<const char*>(&record) + offset, sizeof(word));
  return word;
}

}  // namespace

void CsvWriter::add(std::string_view text) {
  line_ += text;
  line_ += ',';
}

template <typename Number>
void CsvWriter::addNumber(Number number) {
  std::array<char, 32> text;  // the longest double has 24 characters
  const auto result = std::to_chars(text.data(), text.data() + text.size(), number);
  add({text.data(), static_cast<std::size_t>(result.ptr - text.data())});
}

void CsvWriter::add(double number) { addNumber(number); }
void CsvWriter::add(std::int64_t number) { addNumber(number); }
void CsvWriter::add(std::uint64_t number) { addNumber(number); }

void CsvWriter::add(const CycleRecord& record, const RecordColumn& column) {
  switch (column.type) {
    case FieldType::kDouble:
      return add(wordAt<double>(record, column.offset));
    case FieldType::kInt64:
      return add(wordAt<std::int64_t>(record, column.offset));
    case FieldType::kUint64:
      return add(wordAt<std::uint64_t>(record, column.offset));
  }
}

void CsvWriter::endLine() {
  if (!line_.empty()) line_.back() = '\n';
  file_.append(line_);
  line_.clear();
}

}  // namespace tactus
