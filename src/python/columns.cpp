#include "tactus/python/columns.h"

#include <algorithm>
#include <cstring>

namespace tactus {

Columns::Columns(const RecordShape& shape, const std::function<bool(std::string_view)>& has)
    : shape_(shape) {
  for (const RecordField& field : recordFields()) {
    const std::size_t entries = shape.entries(field);
    if (entries > 0 && has(field.name))
      fields_.push_back({&field, entries, shape.isArray(field), {}});
  }
}

void Columns::reserve(std::size_t cycles) {
  for (Field& field : fields_) field.words.reserve(cycles * field.entries);
}

void Columns::add(const CycleRecord& record) {
  for (Field& field : fields_) {
    const std::size_t size = field.words.size();
    field.words.resize(size + field.entries);
    std::memcpy(field.words.data() + size,
                reinterpret_cast<const char*>(&record) + field.field->offset,
                field.entries * sizeof(std::uint64_t));
  }
  ++cycles_;
}

const Columns::Field* Columns::find(std::string_view name) const noexcept {
  const auto found =
      std::ranges::find_if(fields_, [&](const Field& field) { return field.field->name == name; });
  return found == fields_.end() ? nullptr : &*found;
}

std::vector<Columns::Place> Columns::places() const {
  std::vector<Place> places;
  for (const RecordColumn& column : recordColumns(shape_)) {
    const Field* const field = find(column.field);
    if (!field) continue;
    const std::size_t entry = (column.offset - field->field->offset) / sizeof(std::uint64_t);
    places.push_back({column.name, field->field->name, entry});
  }
  return places;
}

}  // namespace tactus
