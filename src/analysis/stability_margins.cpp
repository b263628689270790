#include "tactus/analysis/stability_margins.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "tactus/analysis/bisect.h"

namespace tactus {
namespace {

constexpr double kSoftest = 1e-3;
constexpr double kStiffest = 1e6;
constexpr double kGrid = 1.25;
/// With flexible gears a loop may be unstable between two ratios, and stable again above.
constexpr double kGearedGrid = 1.05;  ///< 1.02 makes `tactus check` five times as long
constexpr double kLargestTimeConstant_s = 100.0;

/// A lag takes away stability once and for good, so its end tells about all smaller ones.
bool hasPhaseMargin(const ContactLoop& loop, double stiffness_ratio, double margin_rad) {
  return isStable(loop, stiffness_ratio) &&
         (margin_rad == 0.0 || isStable(loop, stiffness_ratio, margin_rad));
}

double phaseMargin(const ContactLoop& loop, double stiffness_ratio) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const auto stable = [&](double lag_rad) { return isStable(loop, stiffness_ratio, lag_rad); };
  if (!stable(0.0)) return 0.0;
  for (int degrees = 1; degrees <= 180; ++degrees) {
    if (!stable(degrees * kDegree))
      return bisect((degrees - 1) * kDegree, degrees * kDegree, stable);
  }
  return std::numbers::pi;
}

}  // namespace

/// The first end of stability on the way up: what is above is never met by a contact that loads.
double largestStiffnessRatio(const ContactLoop& loop, double phase_margin_rad) {
  const auto stable = [&](double ratio) { return hasPhaseMargin(loop, ratio, phase_margin_rad); };
  double ratio = kSoftest;
  while (!stable(ratio)) {  // second order at its soft end: slow, hardly damped, hard to judge
    ratio *= kGrid;
    if (ratio > kStiffest) return 0.0;
  }
  const double grid = loop.geared ? kGearedGrid : kGrid;
  while (stable(ratio * grid)) {
    ratio *= grid;
    if (ratio > kStiffest) return std::numeric_limits<double>::infinity();
  }
  return bisect(ratio, ratio * grid, stable);
}

StabilityMargins computeMargins(const ContactLoop& loop, double stiffness_ratio) {
  const double largest = largestStiffnessRatio(loop, 0.0);
  return {largest, largest / stiffness_ratio, phaseMargin(loop, stiffness_ratio)};
}

double smallestTimeConstant(ContactLoop loop, double stiffness_ratio, double phase_margin_rad) {
  const auto stable = [&](double T_s) {
    loop.time_constant_s = T_s;
    return hasPhaseMargin(loop, stiffness_ratio, phase_margin_rad);
  };
  double T_s = loop.time_constant_s;
  while (!stable(T_s * kGrid)) {
    T_s *= kGrid;
    if (T_s > kLargestTimeConstant_s) return std::numeric_limits<double>::infinity();
  }
  return bisect(T_s * kGrid, T_s, stable);
}

}  // namespace tactus
