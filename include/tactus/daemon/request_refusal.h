#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>

#include "tactus/scene/json.h"

namespace tactus {

/// Throws the InputError of what is wrong with a request itself.
[[noreturn]] void refuseRequest(const std::string& problem, const std::string& expectation);

/// For an object with a name that is not one of these. A name that is passed over would be a wish
/// that is silently not met.
void refuseUnknown(const Json& request, std::initializer_list<const char*> known);

/// What is asked for, `do`; empty where that is no text. Json's own == with a text would make a
/// Json of it, which aborts where there is no memory.
std::string wishOf(const Json& request);

/// True or false; absent: false. Refuses anything else.
bool flagOf(const Json& request, const char* name);

/// Refuses what is no number from least to most; name: what it is called then.
double numberOf(const Json& value, const std::string& name, double least, double most);

/// Three entries up to most, either sign; null: as it is. Absent: none.
std::optional<std::array<std::optional<double>, 3>> vectorOf(const Json& request, const char* name,
                                                             double most);

}  // namespace tactus
