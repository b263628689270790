#pragma once

#include <cstdint>

#include "tactus/plant/object_dictionary.h"

namespace tactus {

/// Whether a drive takes a value: its range, and for PDOs the order of changes that CiA 301 wants
/// (COB-id invalid by bit 31, number of entries 0, entries, number of entries, COB-id valid).
AbortCode checkWrite(const ObjectDictionary& objects, const ObjectDescription& object,
                     std::uint32_t value) noexcept;

}  // namespace tactus
