#pragma once

#include <cstdint>
#include <initializer_list>

#include "tactus/canopen/can_frame.h"

namespace tactus::test {

/// A data frame as one writes it by hand.
inline CanFrame canFrame(std::uint32_t id, std::initializer_list<int> bytes) {
  CanFrame frame;
  frame.id = id;
  for (const int byte : bytes) frame.data[frame.size++] = static_cast<std::uint8_t>(byte);
  return frame;
}

/// Little-endian, from byte `first` on.
inline std::uint32_t number(const CanFrame& frame, int first, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= std::uint32_t{frame.data[first + i]} << 8 * i;
  return value;
}

}  // namespace tactus::test
