#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tactus/record/record_fields.h"

namespace tactus {

enum class Comparison : std::uint8_t { kAbove, kAtLeast, kBelow, kAtMost };

/// What a field is compared with: `force_N[0] > 1.2`.
struct TriggerCondition {
  std::string text;                   ///< as it was given
  std::string unit;                   ///< of field and level, "" without one
  std::vector<RecordColumn> columns;  ///< one; of a module field without an index one a module
  Comparison comparison = Comparison::kAbove;
  double level = 0.0;

  bool isRising() const noexcept {
    return comparison == Comparison::kAbove || comparison == Comparison::kAtLeast;
  }
  bool isOfForce() const noexcept { return columns.front().field == "force_sensor_N"; }
};

/// FIELD COMPARISON NUMBER, the comparison one of > >= < <=. FIELD is a name of recordFields(),
/// with an index from 0 where it is a list, or a name of recordColumns(); force_N is
/// force_sensor_N. Of a module field without an index it is the module whose value is the largest,
/// for < and <= the smallest. Throws InputError `--trigger:1:COLUMN: ...`.
TriggerCondition parseTrigger(const std::string& text, const RecordShape& shape);

/// What is compared with the level; NaN where any of it is.
double signalOf(const TriggerCondition& condition, const CycleRecord& record) noexcept;

}  // namespace tactus
