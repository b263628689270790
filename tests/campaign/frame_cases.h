#pragma once

#include <vector>

#include "campaign/cases.h"

namespace tactus::campaign {

void addFrameCases(const Stage& stage, std::vector<Case>& cases);

}  // namespace tactus::campaign
