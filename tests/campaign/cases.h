#pragma once

#include <string>
#include <vector>

#include "campaign/plan.h"
#include "campaign/stage.h"

namespace tactus::campaign {

/// One run of the exhaustive campaign.
struct Case {
  std::string name;  ///< "mode fault_kind mode phase", "pair first second distance_ms",
                     ///< "frame run stream trouble ordinal"; words have no blanks
  Plan plan;
};

/// Of a case: the user comes when all has to be at rest, and lets the arm go on for a moment. kind:
/// of a trouble that is there anyway, for so long; nullptr: none.
Plan latePlan(const Stage& stage, Moment moment, Ending ending, const char* kind, int from_ms,
              int until_ms);

inline constexpr const char* kVariantOfAll = kVariants[0];

/// Every kind of trouble in every mode at 20 phases; phases of the last five with frames that
/// arrive in reverse order. All ordered pairs of kinds at two distances. Every frame of three short
/// runs lost, doubled, delayed by a cycle, and with a bit flipped. The three take
/// turns, each in a mixed order: the first cases are a sample of all.
std::vector<Case> allCases(const Stage& stage);

}  // namespace tactus::campaign
