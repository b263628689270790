#pragma once

#include <string>

#include "tactus/supervisor/gain_change.h"

namespace tactus {

/// As answers and the journal have it.
const char* gainStateName(GainState state) noexcept;

/// Why gains went back, with the figure that tripped; empty: they did not.
std::string gainTroubleText(const GainReport& report);

}  // namespace tactus
