#pragma once

namespace tactus {

/// Where holds(x), true at `inside`, ends before `outside`, to 1e-9 of the way between them.
template <typename Condition>
double bisect(double inside, double outside, Condition holds) {
  constexpr int kBisections = 30;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (inside + outside);
    (holds(middle) ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace tactus
