#pragma once

#include <string_view>

namespace tactus {

/// A number as std::from_chars wants it: without the plus sign that YAML and URDF allow before it.
inline std::string_view withoutPlus(std::string_view number) noexcept {
  const bool has_one_sign =
      number.size() > 1 && number[0] == '+' && number[1] != '+' && number[1] != '-';
  return number.substr(has_one_sign ? 1 : 0);
}

}  // namespace tactus
