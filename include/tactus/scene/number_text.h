#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace tactus {

/// Of a limit, where the text of an error names it: what is printed, rounded, shall be accepted.
inline constexpr double kInsideLimit = 0.999;

/// A number as std::from_chars wants it: without the plus sign that YAML and URDF allow before it.
inline std::string_view withoutPlus(std::string_view number) noexcept {
  const bool has_one_sign =
      number.size() > 1 && number[0] == '+' && number[1] != '+' && number[1] != '-';
  return number.substr(has_one_sign ? 1 : 0);
}

/// A finite number that is all of the text, with a plus sign or without.
inline std::optional<double> finiteNumber(std::string_view text) noexcept {
  text = withoutPlus(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace tactus
