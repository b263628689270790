#pragma once

#include <string>
#include <string_view>

namespace tactus {

/// A name as YAML reads it back: as it is, or in quotes where YAML would take it for something
/// else.
std::string yamlWord(std::string_view name);

}  // namespace tactus
