#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tactus {

/// Members stay in the order in which they were set.
using Json = nlohmann::ordered_json;

/// Indented by two spaces, with a line break at the end. Numbers keep every bit (shortest decimal
/// that reads back the same). What JSON has no number for, NaN and infinity, becomes null, and
/// bytes that are no UTF-8 become U+FFFD.
std::string jsonText(const Json& json);

/// The number, or null for what JSON has none for.
Json finiteOrNull(double value);

}  // namespace tactus
