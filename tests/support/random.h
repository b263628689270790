#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>

#include "tactus/math/types.h"

namespace tactus::test {

/// The same numbers on every machine: the distributions of the standard library are not portable,
/// its engines are.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }

  double logUniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }

  double sign() { return chance(0.5) ? 1.0 : -1.0; }

  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  /// 0 .. count - 1
  int index(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }

  /// low .. high
  int integer(int low, int high) { return low + index(high - low + 1); }

  template <typename Vector = JointVector>
  Vector vector(int size, double low, double high) {
    Vector v(size);
    for (int i = 0; i < size; ++i) v[i] = uniform(low, high);
    return v;
  }

  Vector3 unitVector() {
    while (true) {
      const Vector3 v = vector<Vector3>(3, -1.0, 1.0);
      if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
    }
  }

  Matrix3 rotation() { return Eigen::AngleAxisd(uniform(-3.1, 3.1), unitVector()).matrix(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace tactus::test
