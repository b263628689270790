#pragma once

#include <bit>
#include <cstring>
#include <memory>

namespace tactus {

/// Two numbers that one instruction adds or multiplies, each rounded as it would be alone. Where
/// compilers would not find them by themselves.
using Pair [[gnu::vector_size(16)]] = double;

inline Pair pairAt(const double* first) noexcept {
  Pair pair;
  std::memcpy(&pair, first, sizeof(pair));
  return pair;
}

inline Pair alignedPairAt(const double* first) noexcept {
  return pairAt(std::assume_aligned<sizeof(Pair)>(first));
}

inline void storePair(Pair pair, double* first) noexcept {
  std::memcpy(first, &pair, sizeof(pair));
}

/// What comparing two pairs yields: all bits set where it holds.
using PairMask = decltype(Pair{} < Pair{});

/// As std::min().
inline Pair smaller(Pair a, Pair b) noexcept { return b < a ? b : a; }

inline Pair magnitude(Pair pair) noexcept {
  constexpr long long kSign = 1LL << 63;
  return std::bit_cast<Pair>(std::bit_cast<PairMask>(pair) & ~PairMask{kSign, kSign});
}

}  // namespace tactus
