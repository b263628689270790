#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tactus/run/arm_check.h"
#include "tactus/run/touch_check.h"
#include "tactus/scene/json.h"

namespace tactus {

/// What `tactus check` says of covers, touches and the force to expect, for people and for scripts.
/// Text names a module where there are several.
std::string coversText(const std::vector<CoverReport>& covers);
std::string contactText(const Scene& scene, const ExpectedContact& report);
Json coversJson(const std::vector<CoverReport>& covers);
/// Adds the members touches and, if it is known, expected_peak.
void addContact(const Scene& scene, const ExpectedContact& report, Json& json);

/// A line of the text of `tactus check`.
std::string textLine(const std::string& name, const std::string& value);

}  // namespace tactus
