#pragma once

#include <fmt/format.h>

namespace tactus {

/// As say().
void sayLine(fmt::string_view format, fmt::format_args values) noexcept;

/// "tactusd: ..." as a line on standard error, from any thread but the loop's. A pipe that is full
/// or a journal that hangs must not hold up the log, the status or the answers on the control
/// socket: a line that finds no room within 50 ms is lost, and the next one that does
/// is behind one that says how many were.
template <typename... Values>
void say(fmt::format_string<Values...> format, const Values&... values) noexcept {
  sayLine(format, fmt::make_format_args(values...));
}

}  // namespace tactus
