#pragma once

#include "tactus/math/types.h"

namespace tactus {

/// sin and cos of each of `count` angles (rad), absolute error below 3e-16 for |angle| <= 1e5.
///
/// Own code, because libm's answers differ in the last bit between processors (it picks FMA
/// variants at run time), and a recorded run must replay to the bit on any machine. Method:
/// Cody-Waite reduction to [-pi/4, pi/4], then the minimax polynomials of fdlibm.
void sinCos(const double* angle, int count, double* sine, double* cosine) noexcept;

}  // namespace tactus
