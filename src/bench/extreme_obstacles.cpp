#include <fmt/format.h>

#include "tactus/bench/extreme_case.h"

/// Obstacles that do what walls do not.
namespace tactus {
namespace {

constexpr double kHold_s = 14.0;
constexpr double kGone_s = 8.0;

void addVanishing(std::vector<ExtremeCase>& cases) {
  for (const double stiffness : {10.0, 60.0, 7e3, 1e6}) {
    for (const double time_s : {4.0, 8.0, 11.0}) {
      ExtremeCase extreme{"vanishes", fmt::format("{:g} N/m, after {:g} s", stiffness, time_s)};
      const std::string rest = fmt::format(", vanishes_s: {}", time_s);
      extreme.overrides = {obstaclesAre({bandText(stiffness, rest), profileText(stiffness, rest)}),
                           {"simulation.duration_s", "20"}};
      cases.push_back(extreme);
    }
  }
}

ExtremeCase held(std::string group, std::string name, const Beside& place, double stiffness,
                 double swing_m = 0.0, double frequency_hz = 0.0) {
  ExtremeCase extreme{std::move(group), std::move(name)};
  setHold(kHold_s, extreme.overrides);
  extreme.change = [=](Scene& scene) {
    addBeside(place, stiffness, swing_m, frequency_hz, kGone_s, scene);
  };
  return extreme;
}

void addAppearing(std::vector<ExtremeCase>& cases) {
  for (const double stiffness : {60.0, 1e3, 7e3, 1e5, 1e7}) {
    for (const double depth_m : {0.001, 0.01, 0.06}) {  // the last one in the middle of the link
      cases.push_back(held("appears inside",
                           fmt::format("{:g} N/m, {:g} mm deep", stiffness, 1e3 * depth_m),
                           {0.5, 1.0, -depth_m}, stiffness));
    }
  }
  cases.push_back(
      held("appears inside", "7000 N/m, 1 mm deep, at the near end", {0.01, 1.0, -0.001}, 7000.0));
  cases.push_back(
      held("appears inside", "7000 N/m, 1 mm deep, at the far end", {0.99, -1.0, -0.001}, 7000.0));
}

void addSwinging(std::vector<ExtremeCase>& cases) {
  for (const double stiffness : {60.0, 1e3, 7e3, 1e5}) {
    for (const double frequency_hz : {0.2, 1.0, 3.0, 8.0, 25.0}) {
      for (const double swing_m : {0.002, 0.02}) {
        cases.push_back(held(
            "swings",
            fmt::format("{:g} N/m, {:g} mm at {:g} Hz", stiffness, 1e3 * swing_m, frequency_hz),
            {0.6, -1.0, 0.001}, stiffness, swing_m, frequency_hz));
      }
    }
  }
}

}  // namespace

void addObstacleCases(std::vector<ExtremeCase>& cases) {
  addVanishing(cases);
  addAppearing(cases);
  addSwinging(cases);
}

}  // namespace tactus
