#pragma once

#include <bit>
#include <cmath>
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

/// As std::max().
inline Pair larger(Pair a, Pair b) noexcept { return a < b ? b : a; }

/// Without asking for negative numbers, as std::sqrt() does.
inline Pair squareRoot(Pair pair) noexcept {
#if __has_builtin(__builtin_ia32_sqrtpd)
  return __builtin_ia32_sqrtpd(pair);
#else
  return {std::sqrt(pair[0]), std::sqrt(pair[1])};
#endif
}

/// Whether that holds of one of them.
inline bool isAny(PairMask mask) noexcept {
#if __has_builtin(__builtin_ia32_movmskpd)
  return __builtin_ia32_movmskpd(std::bit_cast<Pair>(mask)) != 0;
#else
  return (mask[0] | mask[1]) != 0;
#endif
}

inline Pair magnitude(Pair pair) noexcept {
  constexpr long long kSign = 1LL << 63;
  return std::bit_cast<Pair>(std::bit_cast<PairMask>(pair) & ~PairMask{kSign, kSign});
}

}  // namespace tactus
