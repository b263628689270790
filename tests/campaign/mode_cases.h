#pragma once

#include <vector>

#include "campaign/cases.h"

namespace tactus::campaign {

inline constexpr int kPhases = 20;  ///< of a mode
inline constexpr int kTrouble_ms = 300;

void addModeCases(const Stage& stage, std::vector<Case>& cases);
void addPairCases(const Stage& stage, std::vector<Case>& cases);

}  // namespace tactus::campaign
