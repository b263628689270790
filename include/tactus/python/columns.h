#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/record/record_fields.h"

namespace tactus {

/// All cycles of a run, field by field: what the log has of each cycle side by side is here a piece
/// of memory of its own, which Python's arrays show without a copy.
class Columns {
 public:
  struct Field {
    const RecordField* field;
    std::size_t entries;
    bool is_array;                     ///< if only of one entry
    std::vector<std::uint64_t> words;  ///< cycle by cycle; the bits of doubles and integers
  };

  /// has: whether there is a field of that name; those without an entry are left out, too.
  Columns(const RecordShape& shape, const std::function<bool(std::string_view)>& has);

  void reserve(std::size_t cycles);
  void add(const CycleRecord& record);

  std::size_t cycles() const noexcept { return cycles_; }
  const std::vector<Field>& fields() const noexcept { return fields_; }
  const Field* find(std::string_view name) const noexcept;
  /// Names of the CSV's columns, in its order, each with its field and entry.
  struct Place {
    std::string name;
    std::string_view field;
    std::size_t entry;
  };
  std::vector<Place> places() const;

 private:
  RecordShape shape_;
  std::vector<Field> fields_;
  std::size_t cycles_ = 0;
};

}  // namespace tactus
