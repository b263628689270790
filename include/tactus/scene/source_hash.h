#pragma once

#include <cstdint>
#include <string_view>

namespace tactus {

/// FNV-1a of 64 bits: whether a file is still the one that was read.
constexpr std::uint64_t sourceHash(std::string_view text) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

}  // namespace tactus
