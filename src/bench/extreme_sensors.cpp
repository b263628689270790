#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tactus/bench/extreme_case.h"

/// Sensors that are noisy, coarse, slow, or wrong.
namespace tactus {
namespace {

struct Met {
  const char* name;
  std::string obstacle;
  bool is_rigid;
};

std::vector<Met> metObstacles() {
  return {{"60 N/m band", bandText(60.0), false},
          {"17000 N/m profile", profileText(17000.0), false},
          {"1e6 N/m profile, rigid arm", profileText(1e6), true}};
}

void addImperfections(std::vector<ExtremeCase>& cases) {
  for (const Met& met : metObstacles()) {
    const auto add = [&](const std::string& name, std::vector<Override> overrides,
                         std::function<void(Scene&)> change = {}) {
      ExtremeCase extreme{"sensor", fmt::format("{}, {}", name, met.name), std::move(overrides)};
      extreme.overrides.push_back(obstaclesAre({met.obstacle}));
      extreme.change = [is_rigid = met.is_rigid, change](Scene& scene) {
        if (is_rigid) makeArmRigid(scene);
        if (change) change(scene);
      };
      cases.push_back(extreme);
    };
    for (const double noise : {0.01, 0.05, 0.1, 0.2, 0.5})
      add(fmt::format("noise {:g} N", noise),
          {{"simulation.tactile_module.noise_N", fmt::format("{}", noise)}});
    for (const double share : {0.05, 0.2, 0.5, 1.0})
      add(fmt::format("{:g} % of samples lost", 100.0 * share),
          {{"simulation.tactile_module.lost_share", fmt::format("{}", share)}});
    for (const double counts_per_N : {1000.0, 20.0, 2.0})
      add(fmt::format("steps of {:g} N", 1.0 / counts_per_N), {},
          [=](Scene& scene) { scene.plant.modules[0].channels.counts_per_N = counts_per_N; });
    for (const double period_s : {0.001, 0.004, 0.008, 0.020})
      add(fmt::format("a sample every {:g} ms", 1e3 * period_s), {},
          [=](Scene& scene) { scene.plant.modules[0].channels.sample_period_s = period_s; });
  }
}

constexpr double kPushFrom_s = 1.0;
constexpr double kPushUntil_s = 7.0;

/// A force that does not give way however far the arm goes, as of a sensor that is stuck.
TactileSample push(double force_N, double angle_rad, std::uint32_t sequence) {
  constexpr double kPlace_m = 0.2;
  const double F_y = force_N * std::cos(angle_rad);
  const double F_z = force_N * std::sin(angle_rad);
  return {F_y, F_z, -kPlace_m * F_z, kPlace_m * F_y, sequence};
}

ExtremeCase pushed(std::string name, std::function<TactileSample(double, std::uint32_t)> force) {
  ExtremeCase extreme{"false reading", std::move(name)};
  setHold(14.0, extreme.overrides);
  extreme.reading = [force](double t_s, TactileSample& sample) {
    sample = t_s >= kPushFrom_s && t_s < kPushUntil_s ? force(t_s, sample.sequence)
                                                      : TactileSample{0, 0, 0, 0, sample.sequence};
  };
  return extreme;
}

void addFalseReadings(std::vector<ExtremeCase>& cases) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (int i = 0; i < 12; ++i) {
    const double angle = kTurn * i / 12.0;
    cases.push_back(pushed(fmt::format("8 N that stay, at {} degrees", 30 * i),
                           [=](double, std::uint32_t n) { return push(8.0, angle, n); }));
  }
  for (const double frequency_hz : {0.2, 2.0, 50.0}) {
    cases.push_back(
        pushed(fmt::format("8 N that turn at {:g} Hz", frequency_hz),
               [=](double t, std::uint32_t n) { return push(8.0, kTurn * frequency_hz * t, n); }));
  }
  cases.push_back(
      pushed("99 N that stay", [](double, std::uint32_t n) { return push(99, 0.3, n); }));
  cases.push_back(
      pushed("101 N, too much", [](double, std::uint32_t n) { return push(101, 0.3, n); }));
  cases.push_back(
      pushed("no number", [](double, std::uint32_t n) { return push(std::nan(""), 0.3, n); }));
  cases.push_back(pushed("moment of 1e300 Nm", [](double, std::uint32_t n) {
    TactileSample sample = push(5.0, 0.3, n);
    sample.moment_z_Nm = 1e300;
    return sample;
  }));
}

/// F_p toggles around zero: the reading around F_th = 1.2 N, a sample above, a sample below.
void addToggling(std::vector<ExtremeCase>& cases) {
  for (const double step_N : {1e-12, 1e-3, 0.1, 1.0}) {
    cases.push_back(pushed(fmt::format("1.2 N and {:g} N more or less in turn", step_N),
                           [=](double, std::uint32_t n) {
                             return push(1.2 + (n % 2 == 0 ? step_N : -step_N), 0.3, n);
                           }));
  }
  for (const double gap_m : {-0.0199, -0.02, -0.0201}) {  // 1.2 N at 20 mm
    ExtremeCase extreme{"F_p around zero",
                        fmt::format("60 N/m band {:g} mm deep, trembling", -1e3 * gap_m)};
    setHold(14.0, extreme.overrides);
    extreme.change = [=](Scene& scene) {
      addBeside({0.5, 1.0, gap_m}, 60.0, 0.0005, 11.0, 8.0, scene);
    };
    cases.push_back(extreme);
  }
}

/// The force changes while the arm hardly moves: the estimate divides by next to nothing.
void addWaylessEstimates(std::vector<ExtremeCase>& cases) {
  for (const double force_N : {1.5, 5.0, 30.0}) {
    for (const double frequency_hz : {1.0, 20.0, 125.0}) {
      cases.push_back(
          pushed(fmt::format("{:g} N, come and gone {:g} times a second", force_N, frequency_hz),
                 [=](double t, std::uint32_t n) {
                   const double phase = frequency_hz * t;
                   return push(phase - std::floor(phase) < 0.5 ? force_N : 0.0, 0.3, n);
                 }));
    }
  }
  for (const double speed : {1e-6, 1e-4}) {
    ExtremeCase extreme{"x_int near zero", fmt::format("approach at {:g} m/s, 1e6 N/m", speed)};
    extreme.overrides = {{"task.trajectory.line.speed_m_per_s", fmt::format("{}", speed)},
                         {"simulation.duration_s", "60"}};
    extreme.change = [](Scene& scene) {
      addBeside({0.5, 1.0, 0.0}, 1e6, 0.0, 0.0, kNoLimit, scene);
      makeArmRigid(scene);
    };
    cases.push_back(extreme);
  }
}

}  // namespace

void addSensorCases(std::vector<ExtremeCase>& cases) {
  addImperfections(cases);
  addFalseReadings(cases);
  addToggling(cases);
  addWaylessEstimates(cases);
}

}  // namespace tactus
