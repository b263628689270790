#pragma once

namespace tactus::test {

inline constexpr double kPeriod_s = 0.001;  ///< of the control cycle

}  // namespace tactus::test
