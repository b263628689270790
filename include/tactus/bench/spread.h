#pragma once

#include <cmath>

namespace tactus {

/// Mean and spread of numbers that come one by one (Welford).
struct Spread {
  long count = 0;
  double mean = 0.0, sum_of_squares = 0.0;

  void add(double x) {
    ++count;
    const double off = x - mean;
    mean += off / static_cast<double>(count);
    sum_of_squares += off * (x - mean);
  }
  double deviation() const { return std::sqrt(sum_of_squares / static_cast<double>(count)); }
};

}  // namespace tactus
