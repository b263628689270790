#pragma once

#include <cstddef>
#include <optional>

#include "tactus/rt/refusal.h"

namespace tactus {

/// Locks all memory, present and future, and keeps `heap_bytes` of touched heap ready for every
/// thread. Once, at start, before other threads exist (what they allocated in stays theirs): later
/// allocations then cost no page fault.
/// Refused under any limit, for later allocations would fail at it.
/// A fork() afterwards marks all pages copy-on-write and brings the faults back.
std::optional<Refusal> lockMemory(std::size_t heap_bytes);

struct PageFaults {
  long minor = 0;  ///< served from memory
  long major = 0;  ///< served from disk
};

/// Of the calling thread since it began; one getrusage().
PageFaults threadPageFaults() noexcept;

}  // namespace tactus
