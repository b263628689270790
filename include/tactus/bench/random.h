#pragma once

#include <cstdint>
#include <random>

namespace tactus {

/// The same numbers on every machine, unlike the distributions of the standard library.
class BenchRandom {
 public:
  explicit BenchRandom(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace tactus
