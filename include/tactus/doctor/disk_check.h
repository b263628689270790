#pragma once

#include <filesystem>

#include "tactus/doctor/finding.h"

namespace tactus {

/// How long a log of so many bytes a second fits into the free space of a folder.
Finding checkDisk(const std::filesystem::path& folder, double free_bytes, double log_bytes_per_s);

}  // namespace tactus
