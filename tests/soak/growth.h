#pragma once

#include <span>

namespace tactus::soak {

struct Reading {
  double t_s, value;
};

/// What the straight line through the last two thirds of the readings (least squares) rises by in
/// their time. 0 of fewer than three.
double growth(std::span<const Reading> readings);

}  // namespace tactus::soak
