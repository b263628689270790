#pragma once

#include <cmath>
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
  double logUniform(double low, double high) {
    return low * std::pow(high / low, uniform(0.0, 1.0));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace tactus
