#pragma once

#include <array>

/// Fault codes of moteus controllers, register 0x00f (docs/protocol/registers.md and fw/error.h in
/// github.com/mjbots/moteus). What is 96 or more limits the output in a valid mode, and is none.
namespace tactus {

struct MoteusFaultRow {
  int code;
  const char* name;
};

const std::array<MoteusFaultRow, 26>& moteusFaultTable() noexcept;
/// nullptr: a code that is not known.
const char* moteusFaultName(int code) noexcept;

}  // namespace tactus
