#pragma once

#include <string>
#include <vector>

#include "tactus/doctor/finding.h"
#include "tactus/doctor/loop_measurement.h"
#include "tactus/scene/json.h"

namespace tactus {

/// What `tactus doctor` found, for a person: findings to mend with their commands, the times of the
/// loop with their distribution, and the verdict.
std::string doctorText(const std::vector<Finding>& findings, const LoopMeasurement& measured);

/// The same for scripts.
Json doctorJson(const std::vector<Finding>& findings, const LoopMeasurement& measured);

}  // namespace tactus
