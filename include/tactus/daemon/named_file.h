#pragma once

#include <string>

namespace tactus {

/// For check() of an option of CLI11 that is a path: one without a name, as of a variable that the
/// shell does not know, is no path, and not the option left out.
inline std::string isNamed(const std::string& word) {
  return word.empty() ? "no name, expected a path" : "";
}

}  // namespace tactus
